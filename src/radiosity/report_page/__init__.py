"""Reports for clients: one HTML page with pictures, plans, tables and warnings, without any outside reference; and its PDF."""
