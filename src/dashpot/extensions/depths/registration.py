"""Registry rows of tests at several depths."""

from dashpot.registry.row import Extension

EXTENSION = Extension(
    "depths",
    handlers={
        "part text": {
            "dashpot.datamodel.fit_diagnostics:DepthStiffness": "dashpot.extensions.depths.text:format_depth_stiffnesses",
        },
        "read document": {"DepthStiffness": "dashpot.extensions.depths.text:complete_document"},
        "fit at several depths": {
            "dashpot.datamodel.relaxation:RampHold": "dashpot.extensions.depths.depth_dependence:fit_depths",
        },
    },
)  # fmt: skip
