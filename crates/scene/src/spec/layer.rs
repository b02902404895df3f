//! Outputs about many bodies together.

use super::outputs::{EVERY, PATH};
use super::{Block, LENGTH, need, opt};

pub const LAYER_OUTPUT: Block = Block {
    name: "Layer",
    doc: "CSV time series of many bodies together: density, number of clusters, bodies in the largest one, mean number of \
          bodies in the cluster of a body, index of segregation of the materials (0 mixed at random, 1 parted), granular \
          temperature <(v - <v>)^2>/D of all and of each material. On a substrate and in two dimensions within the plane.",
    fields: &[
        PATH,
        EVERY,
        opt("gap", LENGTH, "a tenth of the largest radius", "Bodies with a smaller gap are of one cluster."),
        opt(
            "neighbours",
            LENGTH,
            "the largest radius",
            "Bodies with a smaller gap are neighbours for the index of segregation.",
        ),
    ],
};

pub const PAIR_CORRELATION_OUTPUT: Block = Block {
    name: "PairCorrelation",
    doc: "CSV of pair correlations g(r): of all pairs, of pairs of one material, of different ones; 1 for bodies at random in \
          the region that the centres fill, with its edges. Distances beyond the shortest side of the region (half of a period) \
          are left out.",
    fields: &[
        PATH,
        EVERY,
        need("range", LENGTH, "Largest distance of centres."),
        opt("bins", "whole number from 1 to 10000", "100", "Intervals of distance."),
    ],
};

pub const IMPACTS_OUTPUT: Block = Block {
    name: "Impacts",
    doc: "CSV table, written at the end: restitution of contacts between bodies, and effective restitution once both bodies roll \
          again on the substrate, by local density (intervals of 0.1) and normal speed (factors of 2), with means and standard \
          deviations. Contacts with a third body or a wall are counted as crowded, pairs that meet something before they roll \
          as interrupted.",
    fields: &[
        PATH,
        opt(
            "every",
            "whole number of steps, or time such as `\"1 ms\"`",
            "1",
            "Interval between looks; contacts that begin and end between two looks are not seen.",
        ),
        opt(
            "reach",
            LENGTH,
            "six times the largest radius",
            "Radius about a body in which the centres of bodies count for the local density.",
        ),
    ],
};
