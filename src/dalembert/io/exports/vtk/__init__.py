"""Series of VTK files for ParaView."""
