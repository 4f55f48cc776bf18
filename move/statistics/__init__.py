"""What rates and differences can say; docs/rooms.md has the files."""
