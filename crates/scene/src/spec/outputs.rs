//! Outputs of the state and of sums over it.

use super::{Block, FROZEN, Field, need, opt};

pub(super) const PATH: Field = need("path", "text", "Path inside the output folder of the run.");
pub(super) const EVERY: Field = opt(
    "every",
    "whole number of steps, or time such as `\"1 ms\"`",
    "a hundredth of the run",
    "Interval between entries; there is one at the start and one at the end too.",
);

pub const SERIES_OUTPUT: Block = Block {
    name: "Series",
    doc: "CSV time series of global quantities.",
    fields: &[
        PATH,
        EVERY,
        opt(
            "columns",
            "list of names of quantities",
            "kinetic and rotational energy, contacts, maximum overlap, maximum speed",
            "Quantities; those of the energy ledger switch it on.",
        ),
    ],
};

pub const BODIES_OUTPUT: Block = Block {
    name: "Bodies",
    doc: "CSV time series of single bodies: position, velocity, spin, force, torque.",
    fields: &[PATH, EVERY, need("ids", "list of body ids", "Which bodies.")],
};

pub const DUMP_OUTPUT: Block = Block {
    name: "LammpsDump",
    doc: "LAMMPS text dump of all bodies with 17 digits; opens in OVITO.",
    fields: &[PATH, EVERY],
};

pub const VTK_OUTPUT: Block = Block {
    name: "Vtk",
    doc: "VTK `.vtp` files and a `.pvd` collection; opens in ParaView.",
    fields: &[PATH, EVERY, opt("compressed", FROZEN, "true", "Compresses the blocks.")],
};

pub const DATA_OUTPUT: Block =
    Block { name: "LammpsData", doc: "LAMMPS data file of the last state.", fields: &[PATH] };

pub const CONTACTS_OUTPUT: Block = Block {
    name: "Contacts",
    doc: "CSV of what each contact does, one row a contact and entry, of `driver: TimeStep`: the two bodies (the smaller id first; \
          partner -1 is a wall, counted from 0 in the order of `explain`), overlap, unit normal towards the first body, and on that body the \
          normal force, the tangential force and the torque of laws such as rolling friction.",
    fields: &[PATH, EVERY],
};
