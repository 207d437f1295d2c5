"""Recordings of one machine on different days: one cause's size from day to day, and its change."""
