"""Writes objecthood/params.py from the table of parameters: `python generate_params.py`. A test compares the two."""

from __future__ import annotations

import json
from pathlib import Path
from textwrap import fill

from objecthood import _native
from objecthood.errors import ParameterError

HEAD = '''"""Every parameter, with meaning, unit, range and default. Made by generate_params.py; do not edit."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from typing import Any

from objecthood import _native
from objecthood.errors import ParameterError
'''

TAIL = '''

@dataclass(slots=True)
class Params:
    """All parameters, a group for each algorithm. `Params()` is the method `context`."""

    method: str = "context"
    """The method: context | paper."""
{groups}

    def set(self, name: str, value: Any) -> None:
        """Sets the parameter `group.name`. Its range is checked when the parameters are used."""
        group, _, parameter = name.partition(".")
        owner = getattr(self, group, None) if parameter else self
        target = parameter or group
        if owner is None or target not in getattr(owner, "__slots__", ()) or (not parameter and name != "method"):
            raise ParameterError(f"there is no parameter {{name!r}}: write group.name, as objectness.threshold")
        setattr(owner, target, value)

    def to_json(self) -> str:
        """JSON of all parameters, as the native half reads it."""
        return json.dumps(asdict(self))

    @classmethod
    def from_json(cls, text: str) -> Params:
        """Parameters from JSON; what is not named keeps its default."""
        params = cls()
        for group, values in json.loads(text).items():
            if group == "method":
                params.method = values
            else:
                for name, value in values.items():
                    params.set(f"{{group}}.{{name}}", value)
        return params

    def to_toml(self) -> str:
        """TOML of all parameters, as `from_toml` and the command line read it."""
        return _native.params_to_toml(self.to_json())

    @classmethod
    def from_toml(cls, text: str) -> Params:
        """Parameters from TOML text; what is not named keeps its default."""
        return cls.from_json(_native.params_from_toml(text))

    def with_profile(self, profile: str) -> Params:
        """The same parameters with the published noise of a kind of sensor: kinect, stereo, tof or phone."""
        return type(self).from_json(_native.params_with_profile(self.to_json(), profile))
'''


def main() -> str:
    groups: dict[str, list[dict[str, str]]] = {}
    for row in json.loads(_native.parameter_table()):
        groups.setdefault(row["name"].split(".")[0], []).append(row)
    text = HEAD
    for group, rows in groups.items():
        text += f'\n\n@dataclass(slots=True)\nclass {class_name(group)}:\n    """The group `{group}`."""\n'
        text += "".join(parameter(row) for row in rows)
    members = [f"    {group}: {class_name(group)} = field(default_factory={class_name(group)})" for group in groups]
    return text + TAIL.format(groups="\n".join(members))


def class_name(group: str) -> str:
    return "".join(word.capitalize() for word in group.split("_"))


def parameter(row: dict[str, str]) -> str:
    kind, value = typed(row)
    doc = f'{row["meaning"]} Unit: {row["unit"]}. Range: {row["range"]}. Default: {row["default"]} ({row["source"]}).'
    doc = fill(doc, 110, initial_indent='    """', subsequent_indent="    ", break_long_words=False)
    return f'\n    {row["name"].split(".")[1]}: {kind} = {value}\n{doc}"""\n'


def typed(row: dict[str, str]) -> tuple[str, str]:
    """Type and default. A number is whole when its neighbour by a half is refused."""
    default, allowed = row["default"], row["range"]
    if default in ("true", "false"):
        return "bool", default.capitalize()
    if " | " in allowed:
        return "str", json.dumps(default)
    group, name = row["name"].split(".")
    half = json.dumps({group: {name: float(allowed.split(" ..= ")[0]) + 0.5}})
    try:
        _native.params_to_toml(half)
    except ParameterError as refused:
        if "invalid type" in str(refused):
            return "int", default
    return "float", str(float(default))


if __name__ == "__main__":
    Path(__file__).with_name("objecthood").joinpath("params.py").write_text(main(), encoding="utf-8")
