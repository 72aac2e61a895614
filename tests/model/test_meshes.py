from __future__ import annotations

from pathlib import Path

import pytest

from spacerobot.model.library import load
from spacerobot.model.meshes import mesh_path
from spacerobot.support.errors import InputError

URDF = """<robot name="r"><link name="a"><visual><geometry><mesh filename="{}"/></geometry></visual></link></robot>"""


def test_meshes_are_not_needed_to_load() -> None:
    assert load(URDF.format("package://nowhere/a.stl")).name == "r"


def test_paths_inside_their_folder(tmp_path: Path) -> None:
    mesh = tmp_path / "arm" / "meshes" / "a b.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_bytes(b"solid")
    names = ["package://arm/meshes/a b.stl", "package://arm/meshes/a%20b.stl", "arm/./meshes/../meshes/a b.stl"]
    for name in [*names, mesh.as_uri(), str(mesh)]:
        assert mesh_path(name, [tmp_path]).resolve() == mesh, name
        load(URDF.format(name), package_dirs=[tmp_path])
    assert mesh_path("package://arm/meshes/c.stl", [tmp_path]) is None


def test_the_folder_of_a_file_is_its_mesh_folder(tmp_path: Path) -> None:
    path = tmp_path / "urdf" / "arm.urdf"
    path.parent.mkdir()
    (tmp_path / "meshes").mkdir()
    (tmp_path / "meshes" / "a.stl").write_bytes(b"solid")
    path.write_text(URDF.format("meshes/a.stl"))
    assert load(path).mesh_dirs == (path.parent.resolve(),)
    path.write_text(URDF.format((tmp_path / "meshes" / "a.stl").as_uri()))
    with pytest.raises(InputError, match="outside the package folders"):
        load(path)
    assert load(path, package_dirs=[tmp_path]).mesh_dirs[1] == tmp_path.resolve()


def test_links_that_lead_out_are_refused_when_the_file_is_wanted(tmp_path: Path) -> None:
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    inside.mkdir()
    outside.mkdir()
    (outside / "a.stl").write_bytes(b"solid")
    (inside / "a.stl").symlink_to(outside / "a.stl")
    with pytest.raises(InputError, match="through a link"):
        mesh_path("package://inside/a.stl", [inside.parent / "inside" / ".."]) if False else mesh_path(
            "a.stl", [inside]
        )


@pytest.mark.parametrize("name", ["panda", "ur5", "kinova", "xarm7", "talos_full"])
def test_meshes_of_the_examples_are_found(name: str) -> None:
    from lxml import etree

    robot = load(name)
    names = {mesh.get("filename") for mesh in etree.fromstring(robot.urdf).iter("mesh")}
    assert names
    assert all(mesh_path(n, robot.mesh_dirs) is not None for n in names)
