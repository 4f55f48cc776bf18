"""What stands around a figure: parameters, runs, captions, files, notebooks; docs/rooms.md has the files."""
