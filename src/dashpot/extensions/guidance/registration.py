"""Registry rows of suggestions."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "guidance",
    handlers={
        "suggest": {
            "option": "dashpot.extensions.guidance.option_suggestions:suggest_option",
            "command": "dashpot.extensions.guidance.option_suggestions:suggest_command",
            "keyword": "dashpot.extensions.guidance.keyword_suggestions:suggest_keyword",
            "kind": "dashpot.extensions.guidance.kind_synonyms:find_kind_of_file",
        },
        "suggest key": {
            "--machine": "dashpot.extensions.guidance.machine_keys:suggest_machine_key",
        },
        "check arguments": {
            "Python": "dashpot.extensions.guidance.argument_types:refuse_wrong_types",
        },
        "add advice": {
            "function": "dashpot.extensions.guidance.call_errors:add_advice",
            "figure": "dashpot.extensions.guidance.call_errors:refuse_figure_arguments",
            "read": "dashpot.extensions.guidance.read_call:add_read_call",
            "inspect": "dashpot.extensions.guidance.read_call:add_read_call",
        },
        "install command": {
            "extra": "dashpot.extensions.guidance.install_command:format_install_command",
        },
    },
)
