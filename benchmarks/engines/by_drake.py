"""Drake: point contact of the same stiffness without dissipation; discrete with each approximation, and continuous."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from benchmarks.engines.by_mujoco import RADIUS, bare_urdf
from benchmarks.engines.meeting import DURATION, SCENES, Outcome, read
from spacerobot.model.locking import with_locked
from spacerobot.simulation.scene import Scene

logging.getLogger("drake").setLevel(logging.ERROR)  # it says at every load what of a URDF it leaves out

STEPS = (1e-3, 3e-4, 1e-4)
APPROXIMATIONS = ("sap", "similar", "lagged")
INTEGRATORS = ("runge_kutta3", "runge_kutta5", "radau3")
ACCURACIES = (1e-3, 1e-5, 1e-7)


class Rig:
    """A plant with its simulator, set back to the start before every run."""

    def __init__(self, scene: Scene, step: float, approximation: str = "", integrator: str = "", accuracy: float = 0.0):
        from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
        from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
        from pydrake.systems.framework import DiagramBuilder
        from pydrake.systems.primitives import LogVectorOutput

        self.scene = scene
        builder = DiagramBuilder()
        config = MultibodyPlantConfig(time_step=step, contact_model="point")
        if step > 0.0:
            config.discrete_contact_approximation = approximation
        self.plant, _ = AddMultibodyPlant(config, builder)
        self.robot = scene.prepared
        if scene.joints == "locked":
            self.robot = with_locked(self.robot, np.array(scene.pose), self.robot.chain)
        _fill(self.plant, self.robot, scene)
        self.log = LogVectorOutput(self.plant.get_state_output_port(), builder)
        self.diagram = builder.Build()
        self.context = self.diagram.CreateDefaultContext()
        self.simulator = Simulator(self.diagram, self.context)
        if step == 0.0:
            ApplySimulatorConfig(
                SimulatorConfig(integration_scheme=integrator, accuracy=accuracy, max_step_size=0.01), self.simulator
            )
        self.start = self._start()

    def _start(self) -> np.ndarray:
        own = self.plant.GetMyMutableContextFromRoot(self.context)
        if self.scene.joints != "locked":
            for name, value in zip(self.robot.chain, self.scene.pose, strict=True):
                self.plant.GetJointByName(name).set_angle(own, value)
        rod, target = self.plant.GetBodyByName("wrist_rod"), self.plant.GetBodyByName("the_target")
        from pydrake.math import RigidTransform
        from pydrake.multibody.math import SpatialVelocity

        approach = np.array(self.scene.approach)
        tip = self.plant.EvalBodyPoseInWorld(own, rod) @ np.array([0.0, 0.0, 0.16])
        self.plant.SetFloatingBaseBodyPoseInWorldFrame(own, target, RigidTransform(tip - RADIUS * approach))
        motion = SpatialVelocity(np.zeros(3), self.scene.target.speed * approach)
        self.plant.SetFreeBodySpatialVelocity(own, target, motion)
        return np.array(self.plant.GetPositionsAndVelocities(own))

    def collide(self) -> Outcome:
        """One run, all steps inside Drake; the record is read afterwards, near the last separation alone."""
        own = self.plant.GetMyMutableContextFromRoot(self.context)
        self.context.SetTime(0.0)
        self.plant.SetPositionsAndVelocities(own, self.start)
        self.log.FindMutableLog(self.context).Clear()
        self.simulator.Initialize()
        self.simulator.AdvanceTo(DURATION)
        return self.outcome()

    def outcome(self) -> Outcome:
        """From the log of states."""
        found = self.log.FindLog(self.context)
        times, states = found.sample_times(), found.data().T
        target = self.plant.GetBodyByName("the_target")
        at = self.plant.num_positions() + target.floating_velocities_start_in_v() + 3
        speeds = states[:, at : at + 3] @ np.array(self.scene.approach)
        changes = np.flatnonzero(np.abs(np.diff(speeds)) > 1e-8 * self.scene.target.speed)
        last = int(changes[-1]) if changes.size else 0
        low, high = max(0, last - 5), min(len(times), last + 7)
        own = self.plant.GetMyMutableContextFromRoot(self.context)
        depth = np.full(len(times), -1.0)
        for i in range(low, high):
            self.plant.SetPositionsAndVelocities(own, states[i])
            depth[i] = self._depth(own)
        return read(self.scene, times, depth, float(speeds[-1]))

    def _depth(self, own: Any) -> float:
        rod = self.plant.EvalBodyPoseInWorld(own, self.plant.GetBodyByName("wrist_rod"))
        centre = self.plant.EvalBodyPoseInWorld(own, self.plant.GetBodyByName("the_target")).translation()
        normal = -rod.rotation().matrix()[:, 2]
        return float(normal @ (centre - rod @ np.array([0.0, 0.0, 0.16]))) + RADIUS


def _fill(plant: Any, robot: Any, scene: Scene) -> None:
    from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties, Sphere
    from pydrake.math import RigidTransform
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import CoulombFriction
    from pydrake.multibody.tree import (
        PrismaticJoint,
        PrismaticSpring,
        RevoluteJoint,
        RotationalInertia,
        SpatialInertia,
        default_model_instance,
    )

    (instance,) = Parser(plant).AddModelsFromString(bare_urdf(robot.urdf), "urdf")
    if scene.base == "fixed":
        plant.WeldFrames(plant.world_frame(), plant.get_body(plant.GetBodyIndices(instance)[0]).body_frame())
    moments = np.diag(scene.target.inertia_matrix())
    inertia = SpatialInertia.MakeFromCentralInertia(scene.target.mass, np.zeros(3), RotationalInertia(*moments))
    target = plant.AddRigidBody("the_target", default_model_instance(), inertia)
    material = ProximityProperties()
    # both surfaces twice as stiff: in series they are the spring
    AddContactMaterial(0.0, 2.0 * scene.contact.stiffness, CoulombFriction(0.0, 0.0), material)
    rod = plant.GetBodyByName("wrist_rod")
    face = RigidTransform(np.array([0.0, 0.0, 0.16]))
    plant.RegisterCollisionGeometry(rod, face, HalfSpace(), "face", material)
    plant.RegisterCollisionGeometry(target, RigidTransform(), Sphere(RADIUS), "point", material)
    slider = plant.GetJointByName(robot.slider)
    plant.AddForceElement(PrismaticSpring(slider, 0.0, scene.wrist.stiffness))
    slider.set_default_damping(scene.wrist.damping + scene.wrist.equivalent_damping)
    for index in plant.GetJointIndices():
        joint = plant.get_joint(index)
        if not isinstance(joint, PrismaticJoint | RevoluteJoint):
            continue
        joint.set_position_limits([-np.inf], [np.inf])
        armature = float(robot.model.armature[robot.velocity_index(joint.name())])
        if armature:
            plant.AddJointActuator(f"rotor_{joint.name()}", joint).set_default_rotor_inertia(armature)
    plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
    plant.Finalize()


def runs(name: str, quick: bool) -> Iterator[tuple[str, str, Callable[[], Outcome]]]:
    """(engine, setting, run)."""
    scene = SCENES[name]
    for approximation in APPROXIMATIONS[:1] if quick else APPROXIMATIONS:
        for step in STEPS[1:2] if quick else STEPS:
            yield f"Drake discrete, {approximation}", f"{step:g} s", Rig(scene, step, approximation).collide
    for integrator in INTEGRATORS[:1] if quick else INTEGRATORS:
        finest = (1e-9,) if integrator == "runge_kutta3" else ()
        for accuracy in ACCURACIES[:1] if quick else (*ACCURACIES, *finest):
            yield f"Drake continuous, {integrator}", f"{accuracy:g}", Rig(scene, 0.0, "", integrator, accuracy).collide
