"""What can be chosen by name, known without importing what is slow to import."""

from __future__ import annotations

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
