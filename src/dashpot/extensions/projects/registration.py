"""Registry rows of projects."""

from dashpot.registry.row import Command, Extension

EXTENSION = Extension(
    "projects",
    handlers={
        "former document": {
            "convert": "dashpot.extensions.projects.document_versions:convert_document",
            "name schema": "dashpot.extensions.projects.document_versions:name_present_schema",
        },
        "keep": {"project": "dashpot.extensions.projects.project:keep_report"},
        "open folder": {"project": "dashpot.extensions.projects.project:open_last_job"},
    },
    commands=(
        Command("verify", "Many tests", "Recompute a project and check every checksum.", "dashpot.extensions.projects.command", order=7),
    ),
)  # fmt: skip
