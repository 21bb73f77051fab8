from collections.abc import Callable, Sequence
from os import PathLike
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

__version__: str

class Progress(TypedDict):
    done: float
    spp: float
    target_spp: int | None
    elapsed: float
    remaining: float | None
    error: float | None
    error_at_end: float | None
    error_target: float | None
    to_target: list[float] | None

class Picture:
    width: int
    height: int
    layers: list[str]
    spp: float
    seconds: float
    error: tuple[float, float, float] | None
    camera: str
    warnings: list[str]
    interrupted: bool
    plan: list[dict[str, Any]]
    def channels(self, name: str) -> str: ...
    def __getitem__(self, name: str) -> NDArray[np.float32]: ...
    def __contains__(self, name: object) -> bool: ...
    def __len__(self) -> int: ...
    def flat(self, name: str) -> NDArray[np.float32]: ...
    def cryptomatte(self, view_layer: str = "ViewLayer") -> list[tuple[str, str]]: ...
    def save(self, path: str | PathLike[str], *, view_layer: str = "ViewLayer") -> None: ...
    def save_png(self, path: str | PathLike[str], layer: str = "Combined") -> None: ...

class Scene:
    def __init__(self) -> None: ...
    def set_document(self, json: str) -> None: ...
    def edit_document(self, json: str) -> None: ...
    def set_material(self, key: int, json: str) -> None: ...
    def set_materials(self, keys: Sequence[int]) -> None: ...
    def set_mesh(
        self,
        key: int,
        name: str,
        *,
        positions: NDArray[np.float32],
        corner_verts: NDArray[np.int32],
        triangles: NDArray[np.int32],
        normals: NDArray[np.float32] | None = None,
        material_index: NDArray[np.int32] | None = None,
        triangle_polygons: NDArray[np.int32] | None = None,
        uvs: Sequence[tuple[str, NDArray[np.float32]]] = ...,
        colors: Sequence[tuple[str, NDArray[np.float32]]] = ...,
        attributes: Sequence[tuple[str, NDArray[np.float32]]] = ...,
        texture_space: Sequence[Sequence[float]] | None = None,
    ) -> None: ...
    def set_rounds(
        self,
        key: int,
        name: str,
        positions: NDArray[np.float32],
        radii: NDArray[np.float32],
        ends: NDArray[np.uint32],
        smooth: bool = False,
        uvs: Sequence[tuple[str, NDArray[np.float32]]] = (),
        moving: bool = False,
        attributes: Sequence[tuple[str, NDArray[np.float32]]] = (),
    ) -> None: ...
    @staticmethod
    def random_per_island(points: int, edges: NDArray[np.int32]) -> NDArray[np.float32]: ...
    @staticmethod
    def pointiness(
        positions: NDArray[np.float32], normals: NDArray[np.float32], edges: NDArray[np.int32]
    ) -> NDArray[np.float32]: ...
    def remove_shape(self, key: int) -> None: ...
    def set_image_bytes(self, name: str, bytes: bytes, tile: int | None = None) -> None: ...
    def set_image_pixels(
        self, name: str, width: int, height: int, pixels: NDArray[np.float32], linear: bool
    ) -> None: ...
    def set_instances(
        self, objects: NDArray[np.uint32], matrices: NDArray[np.float32], random_ids: NDArray[np.uint32]
    ) -> None: ...
    def set_shape_motion(self, key: int, moved: Sequence[tuple[float, NDArray[np.float32]]]) -> None: ...
    def add_instance_motion(
        self, time: float, instances: NDArray[np.uint32], matrices: NDArray[np.float32]
    ) -> None: ...

class Viewport:
    def __init__(self) -> None: ...
    def show(self, scene: Scene, view: str, changed: bool, **settings: Any) -> None: ...
    def picture(self) -> tuple[int, int, NDArray[np.float32], float] | None: ...
    def has_news(self) -> bool: ...
    def warnings(self) -> list[str]: ...
    def stop(self) -> None: ...

def passes() -> list[dict[str, str]]: ...
def settings() -> list[dict[str, Any]]: ...
def render(
    scene: str | PathLike[str] | Scene | Any,
    *,
    camera: str | None = None,
    size: tuple[int, int] | None = None,
    frame: float | None = None,
    subdivision: int = 2,
    variants: Sequence[str] = ...,
    observer: Callable[[Progress | None], object] | None = None,
    on_picture: Callable[[Picture], object] | None = None,
    picture_interval: float = 1.0,
    plan: bool = False,
    passes: Sequence[str] | str | None = None,
    spp: int | None = None,
    time: float | None = None,
    seed: int | None = None,
    **settings: Any,
) -> Picture: ...
