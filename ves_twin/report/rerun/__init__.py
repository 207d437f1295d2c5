"""Rerun: a recording as an `.rrd` file with its own layout, and a viewer for it."""
