"""Which frame is the tip of an arm, and which joints lead there."""

from __future__ import annotations

import re

from lxml import etree

KNOWN_TIPS = ("wrist_mount", "flange", "panda_hand_tcp", "tool0", "link_eef", "j2s6s200_end_effector")
"""Tips taken without asking, in this order."""

_TIP_LIKE = re.compile(
    r"(^|_)(tcp|tool|tool0|end_?effector|ee|eef|gripper_frame|flange)(_(link|frame))?$", re.IGNORECASE
)
_FINGER = re.compile(r"finger|thumb|knuckle|jaw|index|middle|ring|little|pinky", re.IGNORECASE)
_GRIPPER = re.compile(r"gripper|hand", re.IGNORECASE)


class Tree:
    """The links and joints of a URDF by name.

    Attributes:
        joints: joint name -> element.
        above: link -> the joint whose child it is.
        root: name of the root link.
    """

    def __init__(self, root: etree._Element) -> None:
        self.links: list[str] = [str(link.get("name")) for link in root.findall("link")]
        self.joints: dict[str, etree._Element] = {str(j.get("name")): j for j in root.findall("joint")}
        self.above = {j.find("child").get("link"): name for name, j in self.joints.items()}
        self.root = next(link for link in self.links if link not in self.above)

    def parent(self, joint: str) -> str:
        """Parent link of a joint."""
        return str(self.joints[joint].find("parent").get("link"))

    def child(self, joint: str) -> str:
        """Child link of a joint."""
        return str(self.joints[joint].find("child").get("link"))

    def kind(self, joint: str) -> str:
        """Type of a joint, as URDF names it."""
        return str(self.joints[joint].get("type"))

    def path(self, link: str) -> list[str]:
        """Joints from the root to `link`, fixed ones included."""
        found = []
        while link in self.above:
            joint = self.above[link]
            found.append(joint)
            link = self.parent(joint)
        return found[::-1]

    def chain(self, link: str) -> tuple[str, ...]:
        """Moving joints with one degree of freedom from the root to `link`."""
        return tuple(j for j in self.path(link) if self.kind(j) not in ("fixed", "floating", "planar"))

    def link_of(self, frame: str) -> str | None:
        """The link whose frame `frame` is: a link's own name, or the child link of the joint of that name."""
        if frame in self.links:
            return frame
        return self.child(frame) if frame in self.joints else None


def find_tip(tree: Tree) -> str:
    """The link that an arm would touch things with.

    A known tip if there is one. Else, among the links that no finger leads to, one that is called like a tip
    and lies behind most of the longest chain; else the end of the longest chain, fixed furthest out.
    """
    for name in KNOWN_TIPS:
        if name in tree.links:
            return name
    chains = {link: tree.chain(link) for link in tree.links}
    palms = [link for link in tree.links if not any(_is_finger(tree, joint) for joint in tree.path(link))]
    if not any(chains[link] for link in palms):
        palms = tree.links
    longest = max(len(chains[link]) for link in palms)

    def rank(link: str) -> tuple[bool, int, int]:
        named = bool(_TIP_LIKE.search(link)) and len(chains[link]) >= 0.6 * longest
        return named, len(chains[link]), len(tree.path(link))

    return max(palms, key=rank)


def _is_finger(tree: Tree, joint: str) -> bool:
    if any(_FINGER.search(name) for name in (joint, tree.child(joint))):
        return True
    moving = tree.kind(joint) != "fixed"
    return moving and bool(_GRIPPER.search(joint) or tree.joints[joint].find("mimic") is not None)
