"""Registry row of a kind of test that a plug-in fits."""

from dashpot.registry.row import Extension, KindOfTest

EXTENSION = Extension(
    "plugins",
    kinds=(
            KindOfTest(
                "plug-in", "dashpot.extensions.plugins.read:read_plugged", "dashpot.extensions.plugins.fit_files:plugged_files",
                meant="plug-in",
                nouns={
                    "dashpot.extensions.plugins.datamodel:PluggedTest": "",
                    "dashpot.extensions.plugins.datamodel:PluggedFit": "dashpot.extensions.plugins.figure:draw_plugin_result",
                },
                fits="dashpot.extensions.plugins.fit:fit_plugged", order=18,
        ),
    ),
)  # fmt: skip
