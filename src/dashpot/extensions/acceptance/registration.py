"""Registry rows of acceptance limits."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "acceptance",
    handlers={
        "options": {"limits": "dashpot.extensions.acceptance.command_options:OPTIONS"},
        "recognise limits": {"file": "dashpot.extensions.acceptance.limit_files:recognise_limits"},
        "read limits": {"file": "dashpot.extensions.acceptance.limit_files:read_limits"},
        "judge limits": {"app": "dashpot.extensions.acceptance.app_panel:judge_for_app"},
        "file row": {".toml limits": "dashpot.extensions.acceptance.app_panel:describe_limit_file"},
        "judge interval": {"limits": "dashpot.extensions.acceptance.judgement:judge_interval"},
        "text": {
            "dashpot.extensions.acceptance.datamodel:Acceptance": "dashpot.extensions.acceptance.text:render_acceptance",
        },
        "html": {
            "dashpot.extensions.acceptance.datamodel:Acceptance": "dashpot.extensions.acceptance.page:write_page",
        },
    },
)
