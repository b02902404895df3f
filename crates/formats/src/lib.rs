//! Files of the field: LAMMPS data and dump, VTK, CSV, written atomically
