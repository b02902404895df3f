//! A frame of a dump in memory.

use crate::particles::{Cell, POSITION};
use crate::provenance::Provenance;

/// One frame of a dump.
#[derive(Clone, Debug, PartialEq)]
pub struct DumpFrame {
    /// Number of time steps done.
    pub step: u64,
    /// Simulated time, if the dump gives it.
    pub time: Option<f64>,
    /// Name of the unit system, if the dump gives it.
    pub units: Option<String>,
    /// Provenance, if this program wrote the dump.
    pub provenance: Option<Provenance>,
    /// The box; directions without `pp` are not periodic.
    pub cell: Cell,
    /// The columns, in the order of the file.
    pub columns: Vec<DumpColumn>,
}

/// A column of a dump.
#[derive(Clone, Debug, PartialEq)]
pub struct DumpColumn {
    /// Name in the dump.
    pub name: String,
    /// One value a particle.
    pub values: Values,
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Finite numbers; in `id` and `type`, integers from 1.
    Number(Vec<f64>),
    /// Words: the columns `element` and `typelabel`.
    Word(Vec<String>),
}

impl DumpFrame {
    /// Number of particles.
    pub fn len(&self) -> usize {
        self.columns.first().map_or(0, |column| column.values.len())
    }

    /// Whether there is no particle.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Values of the column of numbers of that name.
    pub fn number(&self, name: &str) -> Option<&[f64]> {
        self.columns.iter().find(|column| column.name == name).and_then(|column| match &column.values {
            Values::Number(values) => Some(values.as_slice()),
            Values::Word(_) => None,
        })
    }

    /// Vectors from three columns of numbers, for instance `["vx", "vy", "vz"]`.
    pub fn vector(&self, names: [&str; 3]) -> Option<Vec<[f64; 3]>> {
        let [x, y, z] = [self.number(names[0])?, self.number(names[1])?, self.number(names[2])?];
        Some(x.iter().zip(y).zip(z).map(|((x, y), z)| [*x, *y, *z]).collect())
    }

    /// Identities of the particles.
    pub fn ids(&self) -> Option<Vec<u32>> {
        Some(self.number("id")?.iter().map(|id| *id as u32).collect())
    }

    /// Indices of the materials, from 0: the column `type` less 1.
    pub fn materials(&self) -> Option<Vec<u16>> {
        Some(self.number("type")?.iter().map(|kind| *kind as u16 - 1).collect())
    }

    /// Positions from `x y z`, `xu yu zu` (unwrapped), `xs ys zs` or `xsu ysu zsu` (in units of the box), in this order.
    pub fn positions(&self) -> Option<Vec<[f64; 3]>> {
        if let Some(positions) = self.vector(POSITION).or_else(|| self.vector(["xu", "yu", "zu"])) {
            return Some(positions);
        }
        let mut scaled = self.vector(["xs", "ys", "zs"]).or_else(|| self.vector(["xsu", "ysu", "zsu"]))?;
        for position in &mut scaled {
            for k in 0..3 {
                position[k] = self.cell.lo[k] + position[k] * (self.cell.hi[k] - self.cell.lo[k]);
            }
        }
        Some(scaled)
    }

    /// Brings the particles into the order of their ids; does nothing without a column `id`.
    pub fn sort_by_id(&mut self) {
        let Some(ids) = self.ids() else { return };
        let mut order: Vec<usize> = (0..ids.len()).collect();
        order.sort_by_key(|i| ids[*i]);
        for column in &mut self.columns {
            match &mut column.values {
                Values::Number(values) => *values = order.iter().map(|i| values[*i]).collect(),
                Values::Word(words) => {
                    *words = order.iter().map(|i| std::mem::take(&mut words[*i])).collect()
                }
            }
        }
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Values::Number(values) => values.len(),
            Values::Word(words) => words.len(),
        }
    }
}
