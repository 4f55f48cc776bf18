"""What stands around a figure: parameters, runs, captions, files, notebooks.

parameters  what a figure can be given, checked, and its runs
data        what is stored of its runs, and what is missing
noise       how much trainings differ, the same in every figure
make        tables, picture and answer from the figure's file, written and shown
captions    title, caption, alternative text
printed     tables as people read them
changes     what a reader changed, and where its files go then
kernels     notebooks executed by papermill
"""
