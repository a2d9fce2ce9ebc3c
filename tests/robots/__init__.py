"""Real robots, as docs/robots.md tells how to write them."""
