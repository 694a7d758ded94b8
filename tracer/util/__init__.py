"""What knows nothing of rays or scenes: settings that are declared once (`setting`), texts, suggestions for names that
are mistyped, the version. Everything may use it; it uses nothing of this program.
"""
