"""What Penumbra's panels have in common."""

ENGINE = "PENUMBRA"


class Panel:
    """A panel of the Properties editor."""

    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context):
        return context.engine in cls.COMPAT_ENGINES

    def _split(self):
        """The layout, names to the left as Blender's own panels have them."""
        self.layout.use_property_split = True
        self.layout.use_property_decorate = False
        return self.layout
