"""YAML from a reader's hands: what JSON could hold as well, and nothing that is other than it looks.

Scalars are YAML 1.2's: 10 is a number, while 010, 0x10, 1:40, on, yes and 2024-10-01 are texts, which YAML 1.1 reads as
8, 16, 100, true, true and a date. Aliases are refused, for a few of them stand for gigabytes; so are tags, equal keys,
and texts that were meant as numbers.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from typing import Any

import yaml

from move.errors import BadInput

LONGEST = 1_000_000  # characters
YAML = "tag:yaml.org,2002:"
TAGS = tuple(YAML + kind for kind in ("null", "bool", "int", "float", "str", "seq", "map"))
WHOLE = "[-+]?(0|[1-9][0-9]*)"
SCALARS = {
    "null": "~|null|Null|NULL|",
    "bool": "true|True|TRUE|false|False|FALSE",
    "int": WHOLE,
    "float": rf"({WHOLE}\.[0-9]*|[-+]?\.[0-9]+)([eE][-+]?[0-9]+)?|[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)",
}
"""What a scalar without quotes is, if it is no text; 1e-4 is none, as in YAML 1.1, and refused."""


class _Loader(yaml.SafeLoader):
    """Reads the kinds of JSON alone."""

    yaml_constructors = {tag: yaml.SafeLoader.yaml_constructors[tag] for tag in (None, *TAGS)}
    yaml_implicit_resolvers = {None: [(YAML + kind, re.compile(rf"(?:{form})\Z")) for kind, form in SCALARS.items()]}

    def compose_node(self, parent: Any, index: Any) -> Any:
        event = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            raise yaml.composer.ComposerError(problem="aliases are not allowed", problem_mark=event.start_mark)
        if (tag := getattr(event, "tag", None)) not in (None, "!"):
            raise yaml.composer.ComposerError(problem=f"tags are not allowed: {tag}", problem_mark=event.start_mark)
        return super().compose_node(parent, index)

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        content = super().construct_mapping(node, deep)
        if len(content) < len(node.value):
            counts = Counter(key.value for key, _ in node.value)
            twice = next((key for key, count in counts.items() if count > 1), node.value[0][0].value)
            raise yaml.constructor.ConstructorError(problem=f"{twice!r} stands twice", problem_mark=node.start_mark)
        return content


def read(text: str, where: str) -> Any:
    """The content of YAML `text`; `where` it stands begins every complaint.

    Raises:
        BadInput: not YAML, or something refused; one line.
    """
    if len(text) > LONGEST:
        raise BadInput(f"{where}: {len(text):,} characters of YAML; allowed are {LONGEST:,}")
    try:
        content = yaml.load(text, _Loader)  # noqa: S506, a SafeLoader that knows less
        json.dumps(content, ensure_ascii=False).encode()  # half a surrogate pair is no text
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise BadInput(f"{where}: not readable as YAML: {' '.join(str(error).split())[:300]}") from error
    refuse_text_numbers(content, where)
    return content


def refuse_text_numbers(content: Any, where: str) -> None:
    """Refuse texts that were meant as numbers, such as 1e-4.

    Raises:
        BadInput: such a text; the message says how to write it.
    """
    if isinstance(content, dict):
        for key, value in content.items():
            refuse_text_numbers(value, f"{where}: {key}")
    elif isinstance(content, list):
        for value in content:
            refuse_text_numbers(value, where)
    elif isinstance(content, str):
        try:
            number = float(content)
        except ValueError:
            return
        raise BadInput(f"{where}: {content[:60]!r} is text to YAML; write the number as {as_yaml(number)}")


def as_yaml(number: float) -> str:
    """How to write a number so that YAML reads it as one; a whole one as an integer.

    >>> as_yaml(1e3), as_yaml(1e-5), as_yaml(1e300)
    ('1000', '1.0e-05', '1.0e+300')
    """
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else yaml.safe_dump(number).split()[0]
