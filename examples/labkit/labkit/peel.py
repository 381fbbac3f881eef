"""A kind of test: the mean force that peels a glued seal off, once it runs."""

from statistics import fmean, stdev


def fit(columns: list, options: dict) -> dict:
    """Return what columns in SI tell; ``options["file"]`` is the name of their file."""
    force = next((one for one in columns if one["role"] == "force"), None)
    if force is None or force["unit"] != "N":
        raise ValueError(f"{options['file']}: no force in N; --column force=NAME --units force=N")
    running = force["values"][len(force["values"]) // 4 :]
    mean, error = fmean(running), stdev(running) / len(running) ** 0.5
    return {
        "numbers": [{"name": "peel_force", "value": mean, "error": error, "unit": "N"}],
        "checks": [
            {
                "name": "peel_steady",
                "passed": max(running) < 1.2 * mean,
                "message": f"The largest force is {max(running) / mean:.2f} of the mean.",
                "remedy": "Peel more slowly.",
            }
        ],
    }
