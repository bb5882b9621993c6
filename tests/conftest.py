"""What all tests share: one thread of linear algebra per worker, and examples of hypothesis that do not vary by run."""

import os

from hypothesis import settings

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(name, "1")

settings.register_profile("suite", deadline=None, derandomize=True)
settings.load_profile("suite")
