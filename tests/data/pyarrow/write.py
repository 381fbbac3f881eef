"""Write the files of this folder with pyarrow 26.0.1: units stand in the metadata of the fields.

python write.py
"""

from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from pyarrow import feather

HERE = Path(__file__).parent
TIME = np.arange(600) * 0.05
DISPLACEMENT = np.clip(TIME - 1, 0, 1) * 2.0
FORCE = np.where(
    TIME < 1, 0, 50 * DISPLACEMENT * (0.6 + 0.4 * np.exp(-np.clip(TIME - 2, 0, None) / 3))
)


def main() -> None:
    fields = [
        pa.field("time", pa.duration("us")),
        pa.field("travel", pa.float64(), metadata={"unit": "mm"}),
        pa.field("load", pa.float32(), metadata={"unit": "kN", "sensor": "17"}),
        pa.field("remark", pa.string()),
    ]
    columns = [
        pa.array(np.round(TIME * 1e6).astype("timedelta64[us]")), DISPLACEMENT,
        (FORCE * 1e-3).astype("f4"), [""] * len(TIME),
    ]  # fmt: skip
    table = pa.table(columns, schema=pa.schema(fields))
    pq.write_table(table, HERE / "bench.parquet", compression="zstd")
    feather.write_feather(table, str(HERE / "bench.arrow"), compression="uncompressed")
    stated = [
        pa.field("time_s", pa.float64()),
        pa.field("travel", pa.float64(), metadata={"unit": "mm"}),
        pa.field("load", pa.float64(), metadata={"unit": "N", "gain": "10"}),
    ]
    table = pa.table([TIME[:60], DISPLACEMENT[:60], FORCE[:60]], schema=pa.schema(stated))
    pq.write_table(table, HERE / "gain.parquet")


if __name__ == "__main__":
    main()
