"""What is wrong with a scene, collected by its checks."""

from collections.abc import Sequence

from mpmcli.core.errors import Problem
from mpmcli.core.suggest import did_you_mean, listing
from mpmcli.scene.report import locate
from mpmcli.scene.tree import Node, member_label


class Report:
    """Collects problems, each at its place in the scene; calling it adds one.

    Attributes
    ----------
    root : the scene as a tree
    problems : in the order in which they were found
    """

    def __init__(self, root: Node):
        self.root = root
        self.problems: list[Problem] = []

    def __call__(self, path: str, message: str, code: str = "invalid", severity: str = "error") -> None:
        self.problems.append(locate(self.root, path, message, code, severity))

    def no_effect(self, path: str, reason: str) -> None:
        """Warn of a key that changes nothing."""
        self(path, f"has no effect, because {reason}", "no_effect", "warning")

    def check_reference(self, path: str, name: str, names: Sequence[str], noun: str) -> None:
        """Refuse a name that is not among ``names``."""
        if name not in names:
            hint = did_you_mean(name, names) or (f" ({listing(names)})" if names else "")
            self(path, f"there is no {noun} '{name}'{hint}", "unknown_reference")

    def section(self, key: str) -> Node | None:
        """The section of a key that has something behind it."""
        node = self.root.value.get(key)
        return None if node is None or node.value is None else node

    def members(self, key: str) -> list[Node]:
        """The members of a list of the scene, valid or not."""
        node = self.root.value.get(key)
        return node.value if node is not None and node.is_sequence else []

    def label(self, key: str, index: int) -> str:
        """The path of a member of a list of the scene."""
        return f"{key}.{member_label(self.root.value[key].value[index], index)}"

    def line(self, path: str) -> int | None:
        """The line of a path in the file."""
        return locate(self.root, path, "").line

    def names_of(self, key: str) -> list[str]:
        """Names of the members of a mapping or list, valid or not."""
        node = self.root.value.get(key)
        if node is not None and node.is_mapping:
            return list(node.value)
        found = [m.value["name"].value for m in self.members(key) if m.is_mapping and "name" in m.value]
        return [name for name in found if isinstance(name, str)]
