//! The engine: bodies slide and roll from event to event.

use granule_geometry::Cell;
use granule_law_api::SurfaceFriction;
use serde::{Deserialize, Serialize};

use super::account::RollingWork;
use super::plate::{Plate, Vector, sum};
use super::setup::{Between, RollingSetup};
use super::side::SideWall;
use crate::body::{Period, Shell};
use crate::cells::Cells;
use crate::engine::Rule;
use crate::fault::{caught, watched};
use crate::neighbours::Neighbours;
use crate::queue::Calendar;
use crate::report::Counts;
use crate::setup::EventError;

/// Partners from here on are walls.
pub(super) const WALLS: u32 = 0xFFFF_0000;
/// The piece of the arc ends.
pub(super) const PIECE: u32 = u32::MAX;
/// The body may leave its shell.
pub(super) const SHELL: u32 = u32::MAX - 1;
/// The path must be looked at again.
pub(super) const AGAIN: u32 = u32::MAX - 2;
/// Events within one contact duration, for each body and in all, before a run counts as stalled.
const STALL: (u64, u64) = (1000, 1_000_000);

/// What a body's next event is.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Aim {
    /// Body, wall, or one of the constants above.
    pub partner: u32,
    /// Pieces that the partner had begun when this was predicted.
    pub seen: u32,
    /// Pieces that the body itself has begun.
    pub pieces: u32,
}

/// What a body does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum Gait {
    Frozen,
    Sliding,
    Rolling,
    Resting,
}

/// Why a piece ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) enum End {
    /// It is long enough.
    Long,
    /// Slip or rolling are over.
    Stops,
    /// Static friction gives way, or a body at rest begins to roll.
    Starts,
    /// The velocity of the plate jumps.
    Jump,
}

/// Where a centre is: place + velocity τ + acceleration τ²/2 + share D(time + τ).
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
#[repr(C, align(64))]
pub(super) struct Path {
    pub time: f64,
    pub place: Vector,
    pub velocity: Vector,
    pub acceleration: Vector,
    pub share: f64,
}

/// The rest of a piece.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Piece {
    pub gait: Gait,
    pub(super) end_by: End,
    /// Velocity R k × Ω of the surface of a sliding body, and its rate.
    pub(super) spin: Vector,
    pub(super) spin_rate: Vector,
    /// Spin about the normal and its deceleration.
    pub(super) upright: f64,
    pub(super) upright_rate: f64,
    /// What friction does to the centre \[m/s²\].
    pub(super) friction: Vector,
    pub end: f64,
}

/// What never changes about a body.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(super) struct Fixed {
    pub id: u32,
    pub material: u16,
    pub radius: f64,
    pub height: f64,
    pub mass: f64,
    /// 1/m; 0 for a frozen body.
    pub inverse_mass: f64,
    /// Q = m R²/I.
    pub inertia_number: f64,
    pub image: [i32; 3],
}

/// Motion of a body at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motion {
    pub place: Vector,
    pub velocity: Vector,
    /// R k × Ω.
    pub spin: Vector,
    /// Spin about the normal \[rad/s\].
    pub upright: f64,
    /// Velocity of the plate.
    pub plate: Vector,
}

impl Motion {
    /// Slip at the contact point (Kondic 1999, Eq. (26)).
    pub fn slip(&self) -> Vector {
        [0, 1].map(|k| self.velocity[k] + self.spin[k] - self.plate[k])
    }
}

/// Bodies that slide, roll and collide.
#[derive(Clone, Debug)]
pub struct RollingEngine {
    pub(super) cell: Cell,
    pub(super) period: Period,
    pub(super) plate: Plate,
    height: f64,
    pub(super) between: Between,
    pub(super) ledger: bool,
    pub(super) friction: Vec<Option<SurfaceFriction>>,
    pub(super) walls: Vec<SideWall>,
    pub(super) wall_rules: Vec<Option<u16>>,
    pub(super) pairs: Vec<Option<u16>>,
    pub(super) rules: Vec<Rule>,
    pub(super) materials: usize,
    pub(super) contact_duration: f64,

    pub(super) paths: Vec<Path>,
    pub(super) pieces: Vec<Piece>,
    pub(super) fixed: Vec<Fixed>,
    pub(super) shells: Vec<Shell>,
    /// Time of the last collision.
    pub(super) last: Vec<f64>,
    pub(super) queue: Calendar<Aim>,
    pub(super) neighbours: Neighbours,
    pub(super) cells: Cells,
    pub(super) found: Vec<u32>,
    pub(super) largest_reach: f64,
    pub(super) now: f64,
    pub(super) counts: Counts,
    pub(super) work: RollingWork,
    pub(super) pieces_begun: u64,
    pub(super) window: (f64, u64),
}

impl RollingEngine {
    /// Sets bodies in motion.
    ///
    /// # Errors
    /// See [`EventError`].
    pub fn new(setup: &RollingSetup) -> Result<Self, EventError> {
        let base = &setup.base;
        crate::engine::check(base)?;
        let input = |message: String| EventError::Input(message);
        let plate = Plate::new(&setup.motion, base.gravity)
            .ok_or_else(|| input("arcs on a plate that turns are not known".to_string()))?;
        if let Between::Arcs { error } = setup.between
            && !(error > 0.0 && error.is_finite())
        {
            return Err(input(format!("the error of arcs must be greater than zero, not {error}")));
        }
        let walls = base
            .walls
            .iter()
            .enumerate()
            .map(|(index, input)| SideWall::new(&input.wall, index))
            .collect::<Result<Vec<_>, _>>()?;
        let short = |rule: &Option<usize>| rule.and_then(|index| u16::try_from(index).ok());
        let count = base.bodies.len();
        let still =
            Path { time: 0.0, place: [0.0; 2], velocity: [0.0; 2], acceleration: [0.0; 2], share: 0.0 };
        let idle = Piece {
            gait: Gait::Frozen,
            end_by: End::Long,
            spin: [0.0; 2],
            spin_rate: [0.0; 2],
            upright: 0.0,
            upright_rate: 0.0,
            friction: [0.0; 2],
            end: f64::INFINITY,
        };
        let mut engine = Self {
            cell: base.cell,
            period: Period::new(base.cell.period()),
            plate,
            height: setup.height,
            between: setup.between,
            ledger: setup.ledger,
            friction: setup.friction.clone(),
            wall_rules: base.walls.iter().flat_map(|wall| wall.rules.iter().map(short)).collect(),
            walls,
            pairs: base.pairs.iter().map(short).collect(),
            rules: watched(&base.rules),
            materials: base.materials,
            contact_duration: base.contact_duration,
            paths: vec![still; count],
            pieces: vec![idle; count],
            fixed: Vec::with_capacity(count),
            shells: vec![Shell::default(); count],
            last: vec![f64::NEG_INFINITY; count],
            queue: Calendar::new(count, Aim::default()),
            neighbours: Neighbours::default(),
            cells: Cells::default(),
            found: Vec::new(),
            largest_reach: 0.0,
            now: 0.0,
            counts: Counts::default(),
            work: RollingWork::default(),
            pieces_begun: 0,
            window: (0.0, 0),
        };
        for body in &base.bodies {
            let known = setup.friction.get(usize::from(body.material)).is_some_and(Option::is_some);
            if !known && !body.frozen {
                return Err(input(format!("body {} has no friction on the plate", body.id)));
            }
            engine.fixed.push(Fixed {
                id: body.id,
                material: body.material,
                radius: body.radius,
                height: if body.frozen { body.position[2] } else { setup.height + body.radius },
                mass: body.mass,
                inverse_mass: if body.frozen { 0.0 } else { 1.0 / body.mass },
                inertia_number: 1.0 / body.inertia_factor,
                image: [0; 3],
            });
        }
        let (_, plate, _) = engine.plate.at(0.0);
        for (index, body) in base.bodies.iter().enumerate() {
            engine.paths[index].place = [body.position[0], body.position[1]];
            if body.frozen {
                continue;
            }
            let motion = Motion {
                place: [body.position[0], body.position[1]],
                velocity: [body.velocity[0], body.velocity[1]],
                spin: [-body.radius * body.spin[1], body.radius * body.spin[0]],
                upright: body.spin[2],
                plate,
            };
            engine.leave(index as u32, 0.0, motion);
        }
        engine.prepare()?;
        Ok(engine)
    }

    /// Simulated time of the last event \[s\].
    pub fn time(&self) -> f64 {
        self.now
    }

    /// What happened so far; sums of energies are zero without the ledger.
    pub fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Pieces of arcs begun so far.
    pub fn pieces(&self) -> u64 {
        self.pieces_begun
    }

    /// Bytes of state.
    pub fn bytes(&self) -> usize {
        self.paths.capacity() * size_of::<Path>()
            + self.pieces.capacity() * size_of::<Piece>()
            + self.fixed.capacity() * size_of::<Fixed>()
            + self.shells.capacity() * size_of::<Shell>()
            + self.last.capacity() * size_of::<f64>()
            + self.queue.bytes()
            + self.neighbours.bytes()
            + self.cells.bytes()
    }

    /// Events up to a simulated time \[s\], but no more than `most`. True if all of them have happened.
    ///
    /// # Errors
    /// [`EventError::NotFinite`] and [`EventError::Stalled`].
    pub fn advance(&mut self, until: f64, most: u64) -> Result<bool, EventError> {
        for _ in 0..most {
            match self.queue.first() {
                Some((time, _)) if time <= until => self.step()?,
                _ => return Ok(true),
            }
        }
        Ok(false)
    }

    fn step(&mut self) -> Result<(), EventError> {
        let Some((time, body, aim)) = self.queue.pop() else { return Ok(()) };
        self.now = time;
        if time - self.window.0 > self.contact_duration {
            self.window = (time, 0);
        }
        self.window.1 += 1;
        let limit = STALL.0 * self.fixed.len() as u64 + STALL.1;
        if self.window.1 > limit {
            let id = self.id(body);
            return Err(EventError::Stalled { time, id, events: limit, span: self.contact_duration });
        }
        match aim.partner {
            PIECE => self.end_piece(body, time),
            SHELL => self.relist(body, time),
            AGAIN => {}
            wall if wall >= WALLS => {
                let wall = (wall - WALLS) as usize;
                let met = |engine: &Self| (engine.id(body), Err(wall), time);
                caught(self, |engine| engine.hit_wall(body, wall, time), met)?;
            }
            other if self.queue.event(other).1.pieces != aim.seen => self.counts.void += 1,
            other => {
                let met = |engine: &Self| (engine.id(body), Ok(engine.id(other)), time);
                caught(self, |engine| engine.collide(body, other, time), met)?;
                self.predict(other, time);
            }
        }
        self.predict(body, time);
        Ok(())
    }

    /// Identity of a body.
    fn id(&self, body: u32) -> u32 {
        self.fixed[body as usize].id
    }

    /// Motion of a body at a time of its piece.
    pub(super) fn motion(&self, body: u32, time: f64) -> Motion {
        let (path, piece) = (&self.paths[body as usize], &self.pieces[body as usize]);
        let (there, plate, _) = self.plate.along_path(path.time, time);
        let dt = time - path.time;
        let place = [0, 1].map(|k| {
            path.place[k] + dt * (path.velocity[k] + 0.5 * dt * path.acceleration[k]) + path.share * there[k]
        });
        let velocity = [0, 1].map(|k| path.velocity[k] + dt * path.acceleration[k] + path.share * plate[k]);
        let spin = match piece.gait {
            Gait::Frozen | Gait::Sliding => sum(piece.spin, dt, piece.spin_rate),
            Gait::Rolling => sum(plate, -1.0, velocity),
            Gait::Resting => [0.0; 2],
        };
        let left = (piece.upright.abs() - dt * piece.upright_rate).max(0.0);
        Motion { place, velocity, spin, upright: left * piece.upright.signum(), plate }
    }

    /// Acceleration of a centre at a time of its piece.
    pub(super) fn acceleration(&self, body: u32, time: f64) -> Vector {
        let path = &self.paths[body as usize];
        if path.share == 0.0 {
            path.acceleration
        } else {
            sum(path.acceleration, path.share, self.plate.at(time).2)
        }
    }

    /// Height of the plane \[m\].
    pub fn height(&self) -> f64 {
        self.height
    }

    pub(super) fn has_ledger(&self) -> bool {
        self.ledger
    }

    pub(super) fn has_arcs(&self) -> bool {
        self.between != Between::EffectiveRestitution
    }

    /// Rule of two bodies.
    #[inline]
    pub(super) fn rule_of(&self, a: u32, b: u32) -> Option<u16> {
        let material = |body: u32| usize::from(self.fixed[body as usize].material);
        self.pairs[material(a) * self.materials + material(b)]
    }
}
