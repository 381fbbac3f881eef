"""Registry row of the kinds of tests, formats and solver inputs of plug-ins."""

from dashpot.registry.row import Extension, FileFormat, KindOfTest

EXTENSION = Extension(
    "plugins",
    file_kinds={
        "plug-in": (
            "a test of a plug-in's kind", "use dashpot fit",
            ("time", "displacement", "force", "stress", "strain", "temperature", "frequency"),
            False, True,
        ),
    },
    kinds=(
            KindOfTest(
                "plug-in", "dashpot.extensions.plugins.read:read_plugged", "dashpot.extensions.plugins.fit_files:plugged_files",
                fit_route="plug-in",
                classes={
                    "dashpot.extensions.plugins.datamodel:PluggedTest": "",
                    "dashpot.extensions.plugins.datamodel:PluginFit": "dashpot.extensions.plugins.figure:draw_plugin_result",
                },
                fits="dashpot.extensions.plugins.fit:fit_plugged", order=18,
        ),
    ),
    handlers={
        "solver input": {"dashpot.registry.plugins:Plugin": "dashpot.extensions.plugins.write_deck:make_writer"},
    },
    formats=(FileFormat("plugin_format", "dashpot.extensions.plugins.read_format", sandboxed=True),),
)  # fmt: skip
