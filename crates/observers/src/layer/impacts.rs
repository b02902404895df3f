//! Collisions of bodies as they happen, and what is left of their speed once they roll again: the restitution after contact
//! and the effective restitution after slip, against density and speed (the conjecture of Kondic 1999, Sec. V).

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

/// Width of the intervals of density.
const DENSITY: f64 = 0.1;

/// A contact of two bodies at one look.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch {
    /// The bodies, the smaller number first.
    pub bodies: (usize, usize),
    /// Unit vector from the second to the first.
    pub normal: [f64; 3],
}

/// What happened at densities and speeds of one interval.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImpactBin {
    /// Local density, from and to.
    pub density: [f64; 2],
    /// Normal speed before contact, from and to \[m/s\].
    pub speed: [f64; 2],
    /// Contacts that have begun and ended.
    pub contacts: u64,
    /// Of these, those in which a third body or a wall took part; they enter no mean.
    pub crowded: u64,
    /// Pairs of which one met something before both rolled again.
    pub interrupted: u64,
    /// Pairs that rolled again undisturbed.
    pub rolled: u64,
    /// Mean restitution of contacts that were not crowded, and its standard deviation; 0 without any.
    pub restitution: [f64; 2],
    /// Mean of the normal speed of separation once both bodies roll again, over that before contact, and its standard
    /// deviation; 0 without any. Negative where they approach again (erratum K-E40).
    pub effective: [f64; 2],
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct Contact {
    speed: f64,
    density: f64,
    normal: [f64; 3],
    crowded: bool,
}

#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
struct After {
    bodies: (usize, usize),
    contact: Contact,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Sums {
    contacts: u64,
    crowded: u64,
    interrupted: u64,
    restitution: Moments,
    effective: Moments,
}

#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Moments {
    count: u64,
    mean: f64,
    squares: f64,
}

impl Moments {
    /// Welford's update.
    fn add(&mut self, value: f64) {
        self.count += 1;
        let from = value - self.mean;
        self.mean += from / self.count as f64;
        self.squares += from * (value - self.mean);
    }

    fn of(&self) -> [f64; 2] {
        let spread = if self.count > 1 { (self.squares / (self.count - 1) as f64).sqrt() } else { 0.0 };
        [self.mean, spread]
    }
}

/// Follows contacts from look to look. Looks must be nearer to each other than a contact lasts.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct ImpactMeter {
    velocity: Vec<[f64; 3]>,
    contacts: BTreeMap<(usize, usize), Option<Contact>>,
    after: Vec<After>,
    sums: BTreeMap<(u64, i64), Sums>,
}

impl ImpactMeter {
    /// A meter that has seen nothing.
    pub fn new() -> Self {
        Self::default()
    }

    /// Looks at all bodies: their velocities \[m/s\], which of them slip on a substrate, which touch a wall, and the contacts
    /// between them. `density` gives the density about a pair; it is asked when a contact begins.
    pub fn look(
        &mut self,
        velocity: &[[f64; 3]],
        slips: &[bool],
        walled: &[bool],
        touches: &[Touch],
        mut density: impl FnMut((usize, usize)) -> f64,
    ) {
        let mut busy: Vec<u32> = walled.iter().map(|walled| u32::from(*walled)).collect();
        for touch in touches {
            busy[touch.bodies.0] += 1;
            busy[touch.bodies.1] += 1;
        }
        let now: BTreeSet<(usize, usize)> = touches.iter().map(|touch| touch.bodies).collect();
        let ended: Vec<(usize, usize)> =
            self.contacts.keys().filter(|bodies| !now.contains(bodies)).copied().collect();
        for bodies in ended {
            if let Some(Some(contact)) = self.contacts.remove(&bodies) {
                self.end(bodies, contact, velocity);
            }
        }
        for touch in touches {
            let bodies = touch.bodies;
            let crowded = busy[bodies.0] > 1 || busy[bodies.1] > 1;
            match self.contacts.get_mut(&bodies) {
                Some(Some(contact)) => {
                    contact.normal = touch.normal;
                    contact.crowded |= crowded;
                }
                Some(None) => {}
                None => {
                    let speed = match self.velocity.is_empty() {
                        true => 0.0,
                        false => -along(&self.velocity, bodies, touch.normal),
                    };
                    // A contact whose beginning was not seen, or that began without approach, tells nothing.
                    let begun = (speed > 0.0).then(|| Contact {
                        speed,
                        density: density(bodies),
                        normal: touch.normal,
                        crowded,
                    });
                    self.contacts.insert(bodies, begun);
                }
            }
        }
        let mut waiting = std::mem::take(&mut self.after);
        waiting.retain(|after| {
            let (i, j) = after.bodies;
            let sums = self.sums.entry(key(&after.contact)).or_default();
            if busy[i] > 0 || busy[j] > 0 {
                sums.interrupted += 1;
                return false;
            }
            if slips[i] || slips[j] {
                return true;
            }
            sums.effective.add(along(velocity, after.bodies, after.contact.normal) / after.contact.speed);
            false
        });
        self.after = waiting;
        velocity.clone_into(&mut self.velocity);
    }

    fn end(&mut self, bodies: (usize, usize), contact: Contact, velocity: &[[f64; 3]]) {
        let sums = self.sums.entry(key(&contact)).or_default();
        sums.contacts += 1;
        if contact.crowded {
            sums.crowded += 1;
            return;
        }
        sums.restitution.add(along(velocity, bodies, contact.normal) / contact.speed);
        self.after.push(After { bodies, contact });
    }

    /// True if all bodies that it follows are among `bodies` ones.
    pub(crate) fn fits(&self, bodies: usize) -> bool {
        let pairs = self.contacts.keys().chain(self.after.iter().map(|after| &after.bodies));
        (self.velocity.is_empty() || self.velocity.len() == bodies)
            && pairs.into_iter().all(|(i, j)| *i < bodies && *j < bodies)
    }

    /// What was seen, by density and then by speed; intervals in which nothing happened are left out.
    pub fn table(&self) -> Vec<ImpactBin> {
        let bin = |(&(density, speed), sums): (&(u64, i64), &Sums)| ImpactBin {
            density: [density as f64 * DENSITY, (density + 1) as f64 * DENSITY],
            speed: [power_of_two(speed), power_of_two(speed + 1)],
            contacts: sums.contacts,
            crowded: sums.crowded,
            interrupted: sums.interrupted,
            rolled: sums.effective.count,
            restitution: sums.restitution.of(),
            effective: sums.effective.of(),
        };
        self.sums.iter().map(bin).collect()
    }
}

/// Relative velocity of two bodies along a normal; positive when they separate.
fn along(velocity: &[[f64; 3]], (i, j): (usize, usize), normal: [f64; 3]) -> f64 {
    (0..3).map(|axis| (velocity[i][axis] - velocity[j][axis]) * normal[axis]).sum()
}

fn key(contact: &Contact) -> (u64, i64) {
    ((contact.density / DENSITY) as u64, exponent(contact.speed))
}

/// Exponent of a positive number, exactly: 2^n <= value < 2^(n + 1).
fn exponent(value: f64) -> i64 {
    (value.to_bits() >> 52) as i64 - 1023
}

fn power_of_two(exponent: i64) -> f64 {
    f64::from_bits(((exponent + 1023).max(0) as u64) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: [f64; 3] = [1.0, 0.0, 0.0];

    fn touch(i: usize, j: usize) -> Touch {
        Touch { bodies: (i, j), normal: X }
    }

    fn frame(meter: &mut ImpactMeter, x: &[f64], slips: &[bool], touches: &[Touch]) {
        let velocity: Vec<[f64; 3]> = x.iter().map(|x| [*x, 0.0, 0.0]).collect();
        meter.look(&velocity, slips, &vec![false; x.len()], touches, |_| 0.25);
    }

    #[test]
    fn a_pair_that_collides_slips_and_rolls() {
        let mut meter = ImpactMeter::new();
        let none = [false; 2];
        frame(&mut meter, &[-0.5, 0.5], &none, &[]);
        frame(&mut meter, &[-0.4, 0.4], &[true; 2], &[touch(0, 1)]);
        frame(&mut meter, &[0.2, -0.2], &[true; 2], &[touch(0, 1)]);
        frame(&mut meter, &[0.45, -0.45], &[true; 2], &[]);
        frame(&mut meter, &[0.3, -0.3], &[false, true], &[]);
        assert_eq!(meter.table()[0].rolled, 0);
        frame(&mut meter, &[0.2, -0.1], &none, &[]);
        let [bin] = meter.table()[..] else { panic!() };
        assert_eq!((bin.contacts, bin.crowded, bin.interrupted, bin.rolled), (1, 0, 0, 1));
        assert_eq!((bin.speed, bin.density), ([1.0, 2.0], [0.2, 0.30000000000000004]));
        assert!((bin.restitution[0] - 0.9).abs() < 1e-15 && (bin.effective[0] - 0.3).abs() < 1e-15);
    }

    #[test]
    fn a_third_body_interrupts_and_crowds() {
        let mut meter = ImpactMeter::new();
        let slips = [true, true, false];
        frame(&mut meter, &[-0.3, 0.3, 1.0], &[false; 3], &[]);
        frame(&mut meter, &[0.0, 0.0, 1.0], &slips, &[touch(0, 1)]);
        frame(&mut meter, &[0.2, -0.2, 1.0], &slips, &[]);
        frame(&mut meter, &[0.2, -0.2, 1.0], &slips, &[touch(1, 2)]);
        // The second contact is joined by a third one.
        frame(&mut meter, &[0.2, -0.2, 1.0], &slips, &[touch(0, 1), touch(1, 2)]);
        frame(&mut meter, &[0.2, -0.2, 1.0], &[false; 3], &[]);
        let table = meter.table();
        let count = |of: fn(&ImpactBin) -> u64| table.iter().map(of).sum::<u64>();
        assert_eq!(count(|bin| bin.interrupted), 1);
        assert_eq!(count(|bin| bin.rolled), 0);
        // 0 and 1 separate as they touch again, so that contact tells nothing; 1 and 2 approach at 1.2 m/s, in company.
        assert_eq!((count(|bin| bin.contacts), count(|bin| bin.crowded)), (2, 1));
        // Approach in company.
        frame(&mut meter, &[-1.0, 0.0, 1.0], &[false; 3], &[]);
        frame(&mut meter, &[-1.0, 0.0, 1.0], &[false; 3], &[touch(0, 1), touch(0, 2)]);
        frame(&mut meter, &[1.0, 0.0, -1.0], &[false; 3], &[]);
        let table = meter.table();
        assert_eq!(table.iter().map(|bin| bin.crowded).sum::<u64>(), 3);
        // Deviation of one value is 0, of none too.
        assert!(table.iter().all(|bin| bin.effective == [0.0; 2]));
    }

    #[test]
    fn exponents_bracket() {
        for value in [1e-9, 0.3, 0.5, 1.0, 7.9] {
            let n = exponent(value);
            assert!(power_of_two(n) <= value && value < power_of_two(n + 1));
        }
    }
}
