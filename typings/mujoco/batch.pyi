from typing import Any

from mujoco import MjModel

class Batch:
    def __init__(self, model: MjModel, *args: Any, **options: Any) -> None: ...
    def __getattr__(self, name: str) -> Any: ...
