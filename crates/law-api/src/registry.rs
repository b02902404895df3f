//! The trait that a law implements, and the registry of all linked laws.

use crate::{
    CollisionEntry, Columns, Impact, LawError, LawInfo, NormalSummary, Oracle, PairContext, Params, Real,
    Stage, SubstrateEntry, TimeScale,
};

/// Version of this interface. A law crate built against another one would register where nobody looks; the number makes
/// such a mistake visible in `granule laws`.
pub const API_VERSION: u32 = 1;

/// A contact law. Implement it for a unit type and call [`register_law!`](crate::register_law).
pub trait ContactLaw: 'static {
    /// What the law says about itself.
    const INFO: LawInfo;

    /// Folds parameters and context into a stage for scalar type `T`.
    ///
    /// # Errors
    /// The combination of parameters and pair cannot be had; the message says what can.
    fn compile<T: Real>(params: &Params, pair: &PairContext) -> Result<Box<dyn Stage<T>>, LawError>;

    /// Time scale of a contact that begins with the given impact; `None` if the law has none of its own.
    ///
    /// # Errors
    /// As for [`compile`](Self::compile).
    fn time_scale(
        params: &Params,
        pair: &PairContext,
        impact: &Impact,
    ) -> Result<Option<TimeScale>, LawError>;

    /// What later stages may rely on; normal laws only.
    fn summary(_params: &Params, _pair: &PairContext) -> Option<NormalSummary> {
        None
    }

    /// Closed form for a single impact.
    fn oracle(params: &Params, pair: &PairContext) -> Oracle;

    /// Columns that the law reads with these parameters: all of [`LawInfo::reads`] or fewer.
    fn reads(_params: &Params) -> Columns {
        Self::INFO.reads
    }

    /// True if the law promises never to create energy with these parameters: [`LawInfo::dissipative`], or false where
    /// one form of a law cannot promise it.
    fn dissipative(_params: &Params) -> bool {
        Self::INFO.dissipative
    }

    /// Distance beyond touching at which the law still acts \[m\].
    fn reach(_params: &Params, _pair: &PairContext) -> f64 {
        0.0
    }
}

type Compile<T> = fn(&Params, &PairContext) -> Result<Box<dyn Stage<T>>, LawError>;

/// One registered law: data and function pointers, so that registries hold no generic items.
pub struct LawEntry {
    /// What the law says about itself.
    pub info: &'static LawInfo,
    /// Crate that registered it.
    pub crate_name: &'static str,
    /// Version of that crate.
    pub crate_version: &'static str,
    /// [`API_VERSION`] that it was built against.
    pub api_version: u32,
    /// [`ContactLaw::compile`] in double precision.
    pub compile_f64: Compile<f64>,
    /// [`ContactLaw::compile`] in single precision.
    pub compile_f32: Compile<f32>,
    /// [`ContactLaw::time_scale`].
    pub time_scale: fn(&Params, &PairContext, &Impact) -> Result<Option<TimeScale>, LawError>,
    /// [`ContactLaw::summary`].
    pub summary: fn(&Params, &PairContext) -> Option<NormalSummary>,
    /// [`ContactLaw::oracle`].
    pub oracle: fn(&Params, &PairContext) -> Oracle,
    /// [`ContactLaw::reach`].
    pub reach: fn(&Params, &PairContext) -> f64,
    /// [`ContactLaw::reads`].
    pub reads: fn(&Params) -> Columns,
    /// [`ContactLaw::dissipative`].
    pub dissipative: fn(&Params) -> bool,
}

impl LawEntry {
    /// The entry of a law.
    pub const fn of<L: ContactLaw>(crate_name: &'static str, crate_version: &'static str) -> Self {
        Self {
            info: &L::INFO,
            crate_name,
            crate_version,
            api_version: API_VERSION,
            compile_f64: L::compile::<f64>,
            compile_f32: L::compile::<f32>,
            time_scale: L::time_scale,
            summary: L::summary,
            oracle: L::oracle,
            reach: L::reach,
            reads: L::reads,
            dissipative: L::dissipative,
        }
    }
}

impl std::fmt::Debug for LawEntry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({} {})", self.info.name, self.crate_name, self.crate_version)
    }
}

inventory::collect!(LawEntry);

/// Registers a law: `register_law!(MyLaw);` at the top level of its module.
#[macro_export]
macro_rules! register_law {
    ($law:ty) => {
        $crate::reexport::inventory::submit! {
            $crate::LawEntry::of::<$law>(env!("CARGO_PKG_NAME"), env!("CARGO_PKG_VERSION"))
        }
    };
}

/// Why no registry could be built, or a name was not found in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RegistryError {
    /// Two crates register the same name.
    Duplicate {
        /// The name.
        name: String,
        /// The two crates.
        crates: [String; 2],
    },
    /// A law was built against another version of this interface.
    ApiVersion {
        /// The law.
        name: String,
        /// Its interface version.
        found: u32,
    },
    /// There is no law of that name.
    Unknown {
        /// The name asked for.
        name: String,
        /// The nearest registered name, if any is near.
        nearest: Option<String>,
        /// All registered names.
        known: Vec<String>,
    },
}

impl std::fmt::Display for RegistryError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Duplicate { name, crates } => {
                write!(f, "law `{name}` is registered twice: by {} and by {}", crates[0], crates[1])
            }
            Self::ApiVersion { name, found } => {
                write!(
                    f,
                    "law `{name}` was built against law interface {found}; this program has {API_VERSION}"
                )
            }
            Self::Unknown { name, nearest, known } => {
                write!(f, "there is no law `{name}`")?;
                if let Some(nearest) = nearest {
                    write!(f, "; did you mean `{nearest}`?")?;
                }
                write!(f, " registered: {}", known.join(", "))
            }
        }
    }
}

impl std::error::Error for RegistryError {}

/// All laws that are linked into this program, ordered by name.
#[derive(Clone, Debug)]
pub struct Registry {
    entries: Vec<&'static LawEntry>,
    substrates: Vec<&'static SubstrateEntry>,
    collisions: Vec<&'static CollisionEntry>,
}

impl Registry {
    /// Collects the laws that registered themselves through `inventory`.
    ///
    /// # Errors
    /// Two laws of the same name, or a law built against another interface version.
    pub fn collect() -> Result<Self, RegistryError> {
        Self::from_entries(inventory::iter::<LawEntry>.into_iter())?
            .with_substrates(inventory::iter::<SubstrateEntry>.into_iter())?
            .with_collisions(inventory::iter::<CollisionEntry>.into_iter())
    }

    /// Adds collision laws, which have names of their own.
    ///
    /// # Errors
    /// As for [`collect`](Self::collect).
    pub fn with_collisions(
        mut self,
        entries: impl Iterator<Item = &'static CollisionEntry>,
    ) -> Result<Self, RegistryError> {
        self.collisions.extend(entries);
        crate::collision::order(&mut self.collisions)?;
        Ok(self)
    }

    /// All collision laws, ordered by name.
    pub fn collisions(&self) -> &[&'static CollisionEntry] {
        &self.collisions
    }

    /// The collision law of that name.
    ///
    /// # Errors
    /// [`RegistryError::Unknown`] with the nearest name and all registered ones.
    pub fn collision(&self, name: &str) -> Result<&'static CollisionEntry, RegistryError> {
        crate::collision::find(&self.collisions, name)
    }

    /// Adds laws of surfaces, which have names of their own.
    ///
    /// # Errors
    /// As for [`collect`](Self::collect).
    pub fn with_substrates(
        mut self,
        entries: impl Iterator<Item = &'static SubstrateEntry>,
    ) -> Result<Self, RegistryError> {
        self.substrates.extend(entries);
        self.substrates.sort_by_key(|entry| (entry.info.name, entry.crate_name));
        for pair in self.substrates.windows(2) {
            if pair[0].info.name == pair[1].info.name {
                return Err(RegistryError::Duplicate {
                    name: pair[0].info.name.to_string(),
                    crates: [pair[0].crate_name.to_string(), pair[1].crate_name.to_string()],
                });
            }
        }
        match self.substrates.iter().find(|entry| entry.api_version != API_VERSION) {
            Some(entry) => {
                Err(RegistryError::ApiVersion { name: entry.info.name.to_string(), found: entry.api_version })
            }
            None => Ok(self),
        }
    }

    /// All laws of surfaces, ordered by name.
    pub fn substrates(&self) -> &[&'static SubstrateEntry] {
        &self.substrates
    }

    /// The law of a surface of that name.
    ///
    /// # Errors
    /// [`RegistryError::Unknown`] with the nearest name and all registered ones.
    pub fn substrate(&self, name: &str) -> Result<&'static SubstrateEntry, RegistryError> {
        self.substrates.iter().copied().find(|entry| entry.info.name == name).ok_or_else(|| {
            let known = || self.substrates.iter().map(|entry| entry.info.name);
            RegistryError::Unknown {
                name: name.to_string(),
                nearest: nearest(name, known()).map(str::to_string),
                known: known().map(str::to_string).collect(),
            }
        })
    }

    /// A registry of the given entries.
    ///
    /// # Errors
    /// As for [`collect`](Self::collect).
    pub fn from_entries(entries: impl Iterator<Item = &'static LawEntry>) -> Result<Self, RegistryError> {
        let mut entries: Vec<_> = entries.collect();
        entries.sort_by_key(|entry| (entry.info.name, entry.crate_name));
        for pair in entries.windows(2) {
            if pair[0].info.name == pair[1].info.name {
                return Err(RegistryError::Duplicate {
                    name: pair[0].info.name.to_string(),
                    crates: [pair[0].crate_name.to_string(), pair[1].crate_name.to_string()],
                });
            }
        }
        if let Some(entry) = entries.iter().find(|entry| entry.api_version != API_VERSION) {
            return Err(RegistryError::ApiVersion {
                name: entry.info.name.to_string(),
                found: entry.api_version,
            });
        }
        Ok(Self { entries, substrates: Vec::new(), collisions: Vec::new() })
    }

    /// All laws, ordered by name.
    pub fn entries(&self) -> &[&'static LawEntry] {
        &self.entries
    }

    /// The law of that name.
    ///
    /// # Errors
    /// [`RegistryError::Unknown`] with the nearest name and all registered ones.
    pub fn get(&self, name: &str) -> Result<&'static LawEntry, RegistryError> {
        self.entries.iter().copied().find(|entry| entry.info.name == name).ok_or_else(|| {
            RegistryError::Unknown {
                name: name.to_string(),
                nearest: nearest(name, self.entries.iter().map(|entry| entry.info.name)).map(str::to_string),
                known: self.entries.iter().map(|entry| entry.info.name.to_string()).collect(),
            }
        })
    }
}

/// The candidate that is most similar to `name`, if it is similar enough to be a slip of the pen.
pub fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = name.to_lowercase();
    candidates
        .map(|candidate| (strsim::jaro_winkler(&lower, &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity >= 0.8)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
