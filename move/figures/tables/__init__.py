"""Tables that several figures share: from episodes to rates, costs and differences, and differences in words.

rates        success rates with intervals, costs, floors and ceilings; what is missing; layouts for print
differences  MOVE minus another method, one variant minus another, item by item, on the mean and over tasks
"""

from move.figures.page.printed import as_markdown, readable, shown
from move.figures.tables.differences import (
    COLUMNS,
    LEVEL,
    above_text,
    as_columns,
    clear_counts,
    counts_text,
    difference_brief,
    difference_means,
    difference_table,
    difference_text,
    difference_verdict,
    differences_at,
    interval_text,
    joined,
    largest,
    mean_columns,
    means_text,
    points,
    rates_text,
    summary,
    tasks_table,
    variant_table,
    verdicts_text,
    with_holm,
    with_verdicts,
)
from move.figures.tables.rates import (
    collection_costs,
    controls,
    demonstrations_made,
    grasp_points,
    printed_success,
    rate_table,
    run_costs,
    task_layout,
    with_level,
    with_paper,
)
