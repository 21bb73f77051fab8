//! Files in: each door fills a `SceneDesc` and `Warnings`, nothing else.
