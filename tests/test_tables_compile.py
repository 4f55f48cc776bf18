"""The shipped LaTeX tables are ready to print: captioned, labelled, in per cent and points, and they compile."""

import re
import shutil
import subprocess

import pytest

from move import paths

SHIPPED = sorted((paths.ROOT / "paper_figures").glob("*.tex"))
DOCUMENT = r"""\documentclass[10pt]{article}
\usepackage[utf8]{inputenc}
\usepackage[T1]{fontenc}
\usepackage[textwidth=7.0in,textheight=9.5in]{geometry}
\usepackage{booktabs,longtable}
\setcounter{totalnumber}{100}
\begin{document}
%s
\end{document}
"""


@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: path.stem)
def test_a_shipped_table_is_one_for_people(path):
    text = path.read_text(encoding="utf-8")
    assert text.count(r"\caption") >= 1 and rf"\label{{tab:{path.stem}}}" in text
    body = text[text.rindex(r"\midrule"):]
    assert not re.search(r"\bnan\b|\bNaN\b|\binf\b|\[[\d.]+\]|\[\]", body), "no NaN and no Python list"
    cells = {cell.strip() for line in body.splitlines() for cell in line.removesuffix(r"\\").split("&")}
    assert not cells & {"move", "adc", "disassemble", "pick-place"}, "human names"


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no pdflatex on this machine")
def test_the_shipped_tables_compile_and_fit_on_a_page(tmp_path):
    parts = [f"{path.read_text(encoding='utf-8')}\n\\clearpage" for path in SHIPPED]
    (tmp_path / "tables.tex").write_text(DOCUMENT % "\n".join(parts), encoding="utf-8")
    done = subprocess.run(["pdflatex", "-halt-on-error", "-interaction=nonstopmode", "tables.tex"], cwd=tmp_path,
                          capture_output=True, text=True, errors="replace", timeout=300)
    assert done.returncode == 0, done.stdout[-2000:]
    log = (tmp_path / "tables.log").read_text(errors="replace").replace("\n", " ")
    assert re.findall(r"Overfull \\hbox \((?:[1-9]\d*)\.\d+pt too wide\) in (?:paragraph|alignment).{80}", log) == []
    assert "Float too large" not in log
