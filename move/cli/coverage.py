"""What a data set covers: coverage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Optional

import typer

from move import paths
from move.cli.by_hand import rectangle
from move.cli.options import Json, app, examples
from move.cli.output import show, show_paths
from move.errors import BadInput
from move.files import refuse_folder

if TYPE_CHECKING:
    import numpy as np

    from move.sim.configuration import Box
    from move.statistics.places import Table


@app.command(epilog=examples("move coverage build/data/NAME.zarr", "move coverage ~/lerobot/pick --radius 6 --next 20",
                             "move coverage OWNER/NAME --within 0,-20,40,20 --out map.png"))
def coverage(
    data: Annotated[str, typer.Argument(help="a folder of demonstrations in any layout, or owner/name of the Hub")],
    radius: Annotated[Optional[float], typer.Option(
        min=0.1, max=1000, help="cm at which half of the success is left (default: measured in simulation, fig. radius)"
    )] = None,
    within: Annotated[Optional[str], typer.Option(
        help="corners of the table's part: x,y,x,y in cm, in the data's frame (default: around the grasps)")] = None,
    coming: Annotated[int, typer.Option("--next", min=1, max=1000, help="placements to propose")] = 10,
    units_file: Annotated[Optional[Path], typer.Option(help="YAML that overrides detected units")] = None,
    out: Annotated[Optional[Path], typer.Option(help="PNG file for a map; a PDF comes next to it")] = None,
    as_json: Json = False,
) -> None:
    """Say where demonstrations grasp, which places they repeat, which holes they leave, and what to add.

    Success is what distance to the nearest place seen says, for Pick-Place from pixels in simulation unless --radius is
    given; where the object's way before the grasps is known (`move collect`), its places are seen, too. Places in
    effect: so many far apart would teach as much.
    """
    paths.refuse_outside_checkout()
    box = rectangle(within) if within is not None else None
    if out is not None:
        if out.suffix != ".png":
            raise BadInput(f"out: {str(out)!r} given; allowed is a file that ends in .png")
        refuse_folder(out)
        refuse_folder(out.with_suffix(".pdf"))
    from move.figures.radius import AT_HOME, measured
    from move.realworld.grasps import grasps
    from move.statistics import places as statistics

    found, curves = grasps(data, units_file=units_file), measured(AT_HOME)
    known = f"{_interval([100 * curve.radii[0] for curve in curves], 1)}, Pick-Place's in simulation, {AT_HOME}"
    if radius is not None:
        curves, known = [replace(curves[0], radii=(radius / 100,))], f"{radius:g}, given"
    table = _part_of_the_table(data, found.places, box)
    new, holes = statistics.next_places(found.seen, table, coming)
    expected = [100 * statistics.expected_success(found.seen, table, curve) / curve.top for curve in curves]
    summary: dict[str, Any] = {
        "data": found.origin, "left out": "; ".join(found.without) or "nothing",
        "doubts": "; ".join(found.doubts) or "none", "grasps": len(found.places),
        "grasps in this part": statistics.inside(found.places, table),
        "places": statistics.in_words(statistics.repetitions(found.places)),
        "part of the table (cm)": ", ".join(f"{100 * value:.1f}" for corner in table for value in corner)
        + " (around these grasps; --within names the part that matters)" * (box is None),
        "radius (cm)": known, "places in effect": round(statistics.effective_number(found.places, curves[0]), 1),
        "largest hole, to the nearest place seen (cm)": round(100 * float(holes[0]), 1),
        "success over this part, of that at a place seen (%)": _interval(expected, 0)}
    proposed = [{"placement": number, "x (cm)": round(100 * float(x), 1), "y (cm)": round(100 * float(y), 1),
                 "nearest before it (cm)": round(100 * float(hole), 1)}
                for number, ((x, y), hole) in enumerate(zip(new, holes, strict=True), 1)]
    if out is not None:
        from move.figures.plots import real_figures, style

        style.use_style()
        figure = real_figures.grasp_figure({"": found.places}, {"": new}, simulated=found.simulated, table=table)
        style.save(figure, out.stem, out.parent)
    if as_json:
        return show({**summary, "next": proposed, "map": str(out.absolute()) if out else None}, True, "")
    show(summary, False, "What these demonstrations cover")
    show(proposed, False, "Where to put the object next")
    if out is not None:
        show_paths([out.absolute()])


def _part_of_the_table(data: str, places: np.ndarray, box: Box | None) -> Table:
    """The part (m) between the corners of `box` (cm), else the one that the grasps span.

    Raises:
        BadInput: they span none, or none of them is in the box.
    """
    from move.statistics.places import inside, spanned

    if box is None:
        if (table := spanned(places)) is None:
            raise BadInput(f"{data}: all grasps are at one place or on one line, which is no part of a table; allowed: "
                           "--within x,y,x,y")
        return table
    given = ((box.low[0] / 100, box.low[1] / 100), (box.high[0] / 100, box.high[1] / 100))
    if not inside(places, given):
        low, high = 100 * places.min(axis=0), 100 * places.max(axis=0)
        corners = ", ".join(f"{value:g}" for value in (*box.low[:2], *box.high[:2]))
        raise BadInput(f"within: {corners} given, where none of the {len(places)} grasps is; they lie from "
                       f"{low[0]:.1f},{low[1]:.1f} to {high[0]:.1f},{high[1]:.1f} cm")
    return given


def _interval(values: Sequence[float], digits: int) -> str:
    """A value, and the range of the others if there are any."""
    value, *ends = (f"{value:.{digits}f}" for value in values)
    return f"{value} [{', '.join(sorted(ends, key=float))}]" if ends else value
