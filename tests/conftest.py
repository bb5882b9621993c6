"""What all tests share: one thread of linear algebra per worker, since there is a worker per processor."""

import os

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")
