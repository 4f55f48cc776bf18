"""What stands under every figure and over every table: title, caption, alternative text.

A figure's `WORDS` say what is drawn and what the marks are; the numbers (how many runs, seeds and episodes) are counted
from the results by `numbers`, and the result in sentences is the figure's `answer`. The pictures' files, their captions
and the LaTeX tables all take their words from here.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from move.errors import BadInput
from move.study.provenance import other_versions
from move.study.results import Result

LONGEST_ALTERNATIVE = 400  # letters of what came out


@dataclass(frozen=True)
class Words:
    """What a figure's file says of it.

    Args:
        title: its question or its name in the paper.
        shown: what is drawn with which marks.
        alt: what kind of figure it is, for readers who cannot see it.
        tables: suffix of a table's name -> its caption.
        others: name -> words of the other pictures of the same file.
    """

    title: str = ""
    shown: str = ""
    alt: str = ""
    tables: Mapping[str, str] = field(default_factory=dict)
    others: Mapping[str, Words] = field(default_factory=dict)


INTERVALS = ("Error bars are 95 % intervals that include how trainings and configurations differ; a cell's training "
             "variance is moderated by that of all like cells.")
POOLED = "Open points rest on a single training: how trainings differ is that of like cells alone."
RATES = "Success in per cent with 95 % intervals, which include how trainings and configurations differ."
DIFFERENCES = ("MOVE minus another method in points, paired by configuration, with 95 % intervals; p after Holm's "
               "adjustment is over the rows of one comparison.")
COSTS = "Minutes that a run takes, median, one core."


@dataclass(frozen=True)
class Caption:
    """A figure's words: title, caption (what is shown, counted numbers), what came out, and the alternative text."""

    title: str
    text: str
    found: str
    alt: str

    def markdown(self) -> str:
        """The caption as the file next to the figure; `read` reads it back."""
        return f"# {self.title}\n\n{self.text}\n\n**What came out.** {self.found}\n\n**Alternative text.** {self.alt}\n"


def read(path: Path) -> Caption:
    """The caption in a file that `Caption.markdown` wrote.

    Raises:
        BadInput: another kind of file.
    """
    parts = path.read_text(encoding="utf-8").rstrip("\n").split("\n\n")
    if len(parts) != 4 or not parts[0].startswith("# "):
        raise BadInput(f"caption {path}: {len(parts)} paragraphs found; allowed is what the figures write: title, "
                       "caption, what came out, alternative text")
    title, text, found, alt = parts
    return Caption(title[2:], text, found.removeprefix("**What came out.** "),
                   alt.removeprefix("**Alternative text.** "))


def caption(words: Words, source: str = "", found: str = "") -> Caption:
    """The words of a figure, with where its numbers come from and what came out."""
    found = _sentence(found) or "Nothing was computed."
    return Caption(words.title, f"{words.shown} {_sentence(source)}".strip(), found, f"{words.alt} {_brief(found)}")


def table_caption(words: Words, suffix: str, source: str = "") -> str:
    """What stands over one of a figure's LaTeX tables, that of `suffix`.

    Raises:
        BadInput: a table that the figure's words do not name.
    """
    if suffix not in words.tables:
        raise BadInput(f"table: {suffix!r} given; allowed are those of the figure's words: {', '.join(words.tables)}")
    return f"{words.tables[suffix]} {_sentence(source)}".strip()


def plain(text: str) -> str:
    """Markdown as one line of plain text, without links.

    >>> plain("**Ten** tasks:\\n- one\\n- two")
    'Ten tasks: one two'
    """
    words = text.replace("**", "").replace("`", "").replace("](", "] (").split()
    return " ".join(word for word in words if word != "-")


def _sentence(text: str) -> str:
    """Plain text that begins with a capital and ends with a full stop."""
    words = plain(text)
    return words[:1].upper() + words[1:] + "." * (words[-1:] not in (".", "")) if words else ""


def _brief(text: str) -> str:
    """The first sentences of a text, as many as an alternative text can bear; at least one."""
    sentences = text.split(". ")
    kept = sentences[:1]
    for sentence in sentences[1:]:
        if sum(map(len, kept)) + len(sentence) > LONGEST_ALTERNATIVE:
            break
        kept.append(sentence)
    return _sentence(". ".join(kept))


def listed(parts: Iterable[object]) -> str:
    """Things in words, apart even where they are numbers with commas.

    >>> listed(["2,000", "3,500", "7,000"])
    '2,000; 3,500 and 7,000'
    """
    words = list(map(str, parts))
    return " and ".join(part for part in ("; ".join(words[:-1]), *words[-1:]) if part)


def numbers(results: list[Result], missing: int, purpose: str) -> str:
    """Observation, budgets, seeds, episodes, runs, those of other versions and what is missing, counted from results.

    Args:
        missing: runs of the figure that are not there.
        purpose: what the profile is for; said where something was trained.
    """
    trained = [result for result in results if result.spec.training]
    sentences = []
    if trained:
        seen = sorted({_observation(result) for result in trained}, reverse=True)
        budgets = sorted({result.spec.collection.timesteps for result in trained if result.spec.collection})
        seeds = Counter(result.spec.model_copy(update={"seed": 0}).hash for result in trained).values()
        episodes = [len(result.rows) for result in trained]
        sentences += [f"From {listed(seen)}", f"{listed(f'{budget:,}' for budget in budgets)} timesteps a data set",
                      f"{_span(seeds, 'seed')} a method and condition, {_span(episodes, 'evaluation episode')} a seed, "
                      f"{sum(episodes):,} in all"]
    seconds = {(part, result.spec.policy_hash if part == "train" else result.spec.hash): spent
               for result in results for part, spent in result.seconds.items()}  # runs may share a training
    untrained = "" if trained else f", {_span([len(result.rows) for result in results], 'attempt')} each"
    sentences.append(f"{len(results)} runs{untrained}, {sum(seconds.values()) / 60:.0f} minutes in all, one core each")
    if others := other_versions(result.provenance for result in results):
        sentences.append(f"Other versions than here computed {listed(others)}")
    if made_on := processors(results):
        sentences.append(f"Compared cells were made on different processors: {listed(made_on)}")
    sentences += [f"{_span([missing], 'more run')} missing"] if missing else []
    sentences += [purpose] if trained else []
    return " ".join(f"{sentence}." for sentence in sentences)


def processors(results: list[Result]) -> list[str]:
    """The processors of trained runs with how many each made, where cells differ in theirs; else nothing.

    A cell is what differs in its seed alone. Rounding, and so a policy, is another one on another processor.
    """
    cells: dict[str, set[str]] = {}
    for result in (trained := [result for result in results if result.spec.training]):
        cells.setdefault(result.spec.model_copy(update={"seed": 0}).hash, set()).add(_processor(result))
    if len(set(map(frozenset, cells.values()))) < 2:
        return []
    counts = Counter(map(_processor, trained)).most_common()
    return [f"{name}, {_span([count], 'run')}" for name, count in counts]


def _processor(result: Result) -> str:
    """Its processor's name without what is the same in all names."""
    return " ".join(result.provenance.get("processor", "unknown").replace("(R)", "").replace("Processor", "").split())


def sample_size(results: list[Result], missing: int) -> str:
    """The sample of an answer, in a sentence: seeds, episodes, and what is missing."""
    trained = [result for result in results if result.spec.training]
    seeds = Counter(result.spec.model_copy(update={"seed": 0}).hash for result in trained).values()
    episodes = [len(result.rows) for result in trained or results]
    sample = [_span(counts, what).replace(" to ", "-") for counts, what in ((seeds, "seed"), (episodes, "episode"))
              if counts]
    lacking = f"{missing} of {missing + len(results)} runs are missing" if missing else "no run is missing"
    return f"{', '.join(sample)} each; {lacking}."


def _observation(result: Result) -> str:
    collection = result.spec.collection
    if collection is not None and result.spec.observation == "rgb":
        return f"pixels ({collection.image_size} px)"
    return "keypoints (perception is given)"


def _span(counts: Iterable[int], what: str) -> str:
    low, high = min(counts), max(counts)
    return f"{low} to {high} {what}s" if low != high else f"{low} {what}{'s' * (low != 1)}"
