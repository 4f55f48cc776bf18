"""What can be chosen by name, known without importing what is slow to import."""

from __future__ import annotations

import re
from typing import Literal

Factors = Literal["object", "object+hand", "object+target", "all"]
Protocol = Literal["random", "sparse", "dense", "circle", "placed"]
PlacementRule = Literal["random", "jittered", "halton"]
ExpertName = Literal["phase", "metaworld"]
Place = Literal["package", "authors"]
Drawing = Literal["plain", "full"]
SpeedLaw = Literal["beta", "uniform", "constant"]
Control = Literal["nothing", "random", "expert", "goal-blind"]
ExportFormat = Literal["lerobot", "zarr"]
HASH = re.compile(r"[0-9a-f]{16}")
"""What a run is called, and no figure."""
