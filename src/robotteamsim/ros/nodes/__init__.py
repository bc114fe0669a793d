"""The nodes: parse, convert, call the core, convert, publish."""
