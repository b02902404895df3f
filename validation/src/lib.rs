//! Comparison of scenes with LAMMPS and LIGGGHTS
