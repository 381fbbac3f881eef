"""The elastic laws among which a user chooses."""

from __future__ import annotations

from typing import Literal, TypeAlias

ElasticKind: TypeAlias = Literal["neo-hooke", "mooney-rivlin", "yeoh", "ogden", "hyperfoam"]
ElasticKindOption: TypeAlias = Literal["auto", ElasticKind]
