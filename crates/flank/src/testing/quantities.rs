//! Numbers that expectations name.

use std::cell::RefCell;
use std::collections::HashMap;
use std::sync::Arc;

use flank_chain_dsl::{ContactNumber, DeviationNumber, Expected, Job, PointSet, Quantity, SolidNumber};
use flank_expr::{Expr, Graph};
use flank_solver::Body;

use crate::compare::deviation;
use crate::compare::deviation_result::DeviationResult;
use crate::compare::map::{Named, find};
use crate::contact::result::{ContactResult, TransmissionError};
use crate::contact::{self, backlash, interference};
use crate::convert::Conversion;
use crate::project::failure::Failure;
use crate::project::remark::RemarkKind;
use crate::project::requests::{ContactRequest, JobSelection, Onto};
use crate::project::spec::Origin;
use crate::project::units::counted;
use crate::solve::body::{refusal, space};
use crate::solve::cut;
use crate::testing::points::Tested;
use crate::testing::values::values;

/// Positions of a pitch at which contacts are looked at, and of a motion at which other machines are.
const POSITIONS: u32 = 60;
pub(super) const FOLLOWED: u32 = 7;

/// What is known of a job that is tested, each worked out once.
pub(super) struct Known<'t, 'j, 'g> {
    pub(super) tested: &'t Tested<'j, 'g>,
    pub(super) graph: &'g Graph,
    /// All jobs of the file with few points, for surfaces of others.
    pub(super) jobs: &'j [Job<'g>],
    pub(super) which: &'j JobSelection,
    origin: &'j Origin,
    contacts: RefCell<HashMap<usize, Result<Arc<ContactResult>, String>>>,
    bodies: RefCell<HashMap<usize, Result<Arc<Body>, String>>>,
    deviations: RefCell<HashMap<[String; 2], Arc<DeviationResult>>>,
}

type Number = Result<f64, String>;

impl<'t, 'j, 'g> Known<'t, 'j, 'g> {
    pub(super) fn new(
        tested: &'t Tested<'j, 'g>,
        graph: &'g Graph,
        (jobs, which, origin): (&'j [Job<'g>], &'j JobSelection, &'j Origin),
    ) -> Known<'t, 'j, 'g> {
        Known {
            tested,
            graph,
            jobs,
            which,
            origin,
            contacts: RefCell::default(),
            bodies: RefCell::default(),
            deviations: RefCell::default(),
        }
    }

    /// A quantity, mm and radians; or why it is not known.
    pub(super) fn number(&self, of: &Quantity<'g>) -> Result<Number, Failure> {
        match of {
            Quantity::Contact { contact, number } => self.of_contact(*contact, *number),
            Quantity::Solid { solid, number } => self.of_solid(*solid, *number),
            Quantity::Deviation { surfaces, number } => self.of_deviation(surfaces, *number),
            Quantity::Extreme { surface, over, value, known, is_highest } => {
                self.extreme((*surface, *over), (*value, known), *is_highest)
            }
            Quantity::Position { onto, axis, at } => self.position(onto, axis, at),
        }
    }

    fn of_contact(&self, index: usize, number: ContactNumber) -> Result<Number, Failure> {
        let is_known = self.contacts.borrow().contains_key(&index);
        if !is_known {
            let found = self.contact(index)?;
            self.contacts.borrow_mut().insert(index, found);
        }
        let found = self.contacts.borrow()[&index].clone();
        let contact = &self.tested.job.contacts[index];
        Ok(found.and_then(|result| {
            contact_number(&result, number, contact).ok_or_else(|| {
                let short = result.remarks.iter().find(|of| of.kind == RemarkKind::RollTooShort);
                let why = result.not_done.first().map(|why| &why.message).or(short.map(|of| &of.message));
                let why = why.map_or(String::new(), |why| format!(": {why}"));
                format!("contact {} has no such number{why}", contact.name)
            })
        }))
    }

    fn contact(&self, index: usize) -> Result<Result<Arc<ContactResult>, String>, Failure> {
        let Tested { job, session, .. } = *self.tested;
        let contact = &job.contacts[index];
        let request = ContactRequest { positions: POSITIONS, ..ContactRequest::new(self.which.clone()) };
        let (mut result, members, rolling) = match contact::numbers(job, contact, &request, session) {
            Ok(found) => found,
            Err(Failure::Input(reason)) => return Ok(Err(reason)),
            Err(other) => return Err(other),
        };
        let Some(rolling) = &rolling else { return Ok(Ok(Arc::new(result))) };
        let none = vec![0.0; contact.errors.len()];
        if self.is_asked(index, |number| matches!(number, ContactNumber::Backlash | ContactNumber::NormalBacklash)) {
            let (found, unsound) = backlash::of(job, &members, &request, &none, rolling, session)?;
            result.backlash = found.map(|(backlash, _)| backlash);
            result.not_done.extend(unsound);
        }
        if self.is_asked(index, |number| number == ContactNumber::Clearance) {
            result.clearances = interference::of_spaces(job, &members, &none, rolling, session)?.clearances;
        }
        Ok(Ok(Arc::new(result)))
    }

    /// Whether an expectation of the job is about such a number of a contact.
    fn is_asked(&self, of: usize, is_meant: impl Fn(ContactNumber) -> bool) -> bool {
        let is_one = |(_, quantity): &(Expr<'g>, Quantity<'g>)| match quantity {
            Quantity::Contact { contact, number } => *contact == of && is_meant(*number),
            _ => false,
        };
        self.tested.job.expectations.iter().any(|expectation| match &expectation.what {
            Expected::Value { quantities, .. } => quantities.iter().any(is_one),
            _ => false,
        })
    }

    fn of_solid(&self, index: usize, number: SolidNumber) -> Result<Number, Failure> {
        let is_known = self.bodies.borrow().contains_key(&index);
        if !is_known {
            let Tested { job, session, .. } = *self.tested;
            let found = match space::body(job, &job.solids[index], session) {
                Ok(space) => Ok(Arc::new(space.body)),
                Err(failure) => Err(refusal::no_body(&job.solids[index], failure)?.message),
            };
            self.bodies.borrow_mut().insert(index, found);
        }
        let body = self.bodies.borrow()[&index].clone();
        let name = &self.tested.job.solids[index].name;
        Ok(body.and_then(|body| {
            let is_even = body.arrangement().is_closed() && body.distinct() == 1;
            let is_of_all = matches!(number, SolidNumber::Volume | SolidNumber::Area | SolidNumber::Thickness(_));
            let is_extreme = matches!(number, SolidNumber::TipDiameter | SolidNumber::RootDiameter);
            let is_told = is_even || is_of_all || is_extreme && body.arrangement().is_closed();
            if !is_told {
                return Err(format!("{name} has no such number: it is no gear with equal teeth about an axis"));
            }
            Ok(match number {
                SolidNumber::Volume => body.mass_properties().volume,
                SolidNumber::Area => body.mass_properties().area,
                SolidNumber::TipDiameter => 2.0 * body.tip(),
                SolidNumber::RootDiameter => 2.0 * body.root(),
                SolidNumber::FormDiameter if body.is_external() => {
                    2.0 * body.form().into_iter().fold(f64::MIN, f64::max)
                }
                SolidNumber::FormDiameter => 2.0 * body.form().into_iter().fold(f64::MAX, f64::min),
                // of a bar at an x
                SolidNumber::Thickness(at) => {
                    let depth = if body.arrangement().is_closed() { 0.5 * at } else { at };
                    let found = body.arc_thickness(depth);
                    found.ok_or_else(|| format!("{name} has no tooth thickness at {at} mm"))?
                }
                SolidNumber::Span(teeth) => {
                    let found = body.span(teeth).map(|span| span.width);
                    found.ok_or_else(|| format!("no planes touch {name} over {teeth} teeth"))?
                }
                SolidNumber::OverBalls(ball) => {
                    let found = body.ball(ball).map(|found| found.over_balls);
                    found.map_err(|_| format!("no ball of {ball} mm touches both flanks of {name} and nothing else"))?
                }
            })
        }))
    }

    fn of_deviation(&self, surfaces: &[String; 2], number: DeviationNumber) -> Result<Number, Failure> {
        let is_known = self.deviations.borrow().contains_key(surfaces);
        if !is_known {
            let pair = [self.named(&surfaces[0])?, self.named(&surfaces[1])?];
            let found = deviation::measure(pair, false, self.tested.session)?;
            let found = found.result(Vec::new(), self.origin);
            self.deviations.borrow_mut().insert(surfaces.clone(), Arc::new(found));
        }
        let found = Arc::clone(&self.deviations.borrow()[surfaces]);
        const UM: f64 = 1e-3;
        let direction = |k: usize| found.directions[k].as_ref();
        let value = match number {
            DeviationNumber::Turn => found.turn_deg.map(f64::to_radians),
            DeviationNumber::Rms => found.rms_um.map(|um| UM * um),
            DeviationNumber::Lowest => found.lowest_um.map(|um| UM * um),
            DeviationNumber::Highest => found.highest_um.map(|um| UM * um),
            DeviationNumber::Slope(k) => direction(k).map(|of| UM * of.slope_um),
            DeviationNumber::Crowning(k) => direction(k).map(|of| UM * of.crowning_um),
            DeviationNumber::Bias => found.bias_um.map(|um| UM * um),
        };
        Ok(value.ok_or_else(|| {
            let why = found.not_done.first().map_or(String::new(), |why| format!(": {}", why.message));
            format!("{} and {} have no such number{why}", surfaces[0], surfaces[1])
        }))
    }

    /// A surface of any job of the file.
    pub(super) fn named(&self, name: &str) -> Result<Named<'j, 'g>, Failure> {
        Ok(find(self.jobs, name)?)
    }

    fn extreme(
        &self,
        (index, over): (usize, PointSet),
        (value, known): (Expr<'g>, &[(&'static str, Expr<'g>)]),
        is_highest: bool,
    ) -> Result<Number, Failure> {
        let points = self.tested.set(index, over)?;
        let surface = self.tested.surface(index);
        let values = values(self.tested, index, (surface.sample.as_ref(), &points), (value, known));
        let unknown = values.iter().filter(|value| value.is_none()).count();
        if unknown > 0 {
            let all = counted(points.len(), "point");
            let why = cut::unknown_of(self.tested.job, surface, &points, self.tested.session);
            let why = why.first().map_or(String::new(), |why| format!(": {why}"));
            return Ok(Err(format!("{unknown} of {all} of {} have no such value{why}", surface.name)));
        }
        let found = values.into_iter().flatten().reduce(if is_highest { f64::max } else { f64::min });
        Ok(found.ok_or_else(|| format!("{} has no such point", surface.name)))
    }

    fn position(&self, onto: &Job<'g>, axis: &str, at: &[Option<f64>]) -> Result<Number, Failure> {
        let Tested { job, session, .. } = *self.tested;
        let mut index = 0;
        let conversion = Conversion::at_positions(self.graph, (job, onto), (&Onto::default(), session), |source| {
            let wanted: Vec<f64> = source
                .motions
                .iter()
                .zip(&source.ranges)
                .map(|(motion, range)| {
                    let place = job.motions.iter().position(|own| own.variable == motion.variable);
                    let given = place.and_then(|place| at.get(place).copied().flatten());
                    given.unwrap_or(0.5 * (range.low + range.high))
                })
                .collect();
            let mut positions = source.positions(FOLLOWED as usize);
            // of one motion positions stand in order
            index = match wanted[..] {
                [wanted] => positions.partition_point(|position| position[0] < wanted),
                _ => positions.len(),
            };
            positions.insert(index, wanted);
            positions
        });
        let conversion = match conversion {
            Ok(conversion) => conversion,
            Err(Failure::Input(reason)) => return Ok(Err(reason)),
            Err(other) => return Err(other),
        };
        let told = conversion.failures();
        let name = &conversion.machine.name;
        let Some(k) = conversion.free.iter().position(|free| free.name == axis) else {
            return Ok(Err(format!("axis {axis} of {name} does not move the tool")));
        };
        Ok(match (told.first(), conversion.line.get(index)) {
            (None, Some(posture)) => Ok(posture.axes[k]),
            (Some(why), _) => Err(why.message.clone()),
            (None, None) => Err(format!("no posture of {name} was found")),
        })
    }
}

fn contact_number(of: &ContactResult, number: ContactNumber, contact: &flank_chain_dsl::Contact<'_>) -> Option<f64> {
    let middle = of.middle.as_ref();
    let is_angle = |dimension| crate::project::units::is_angle(dimension);
    let shown = |dimension, value: f64| if is_angle(dimension) { value.to_radians() } else { value };
    // told in urad or um
    let fine = |value: f64| if is_angle(contact.lag.dimension) { 1e-6 * value } else { 1e-3 * value };
    match number {
        ContactNumber::Ratio => of.ratio,
        ContactNumber::PeakToPeak => of.error.as_ref().and_then(TransmissionError::whole).map(fine),
        ContactNumber::Turn => middle.map(|middle| shown(contact.roll.dimension, middle.turn)),
        ContactNumber::Lag => middle.map(|middle| shown(contact.lag.dimension, middle.error)),
        ContactNumber::Parabola => middle.map(|middle| {
            let per_roll = if is_angle(contact.roll.dimension) { 1f64.to_degrees() } else { 1.0 };
            fine(middle.parabola) * per_roll * per_roll
        }),
        ContactNumber::Backlash => of.backlash.as_ref().map(|room| shown(contact.lag.dimension, room.least)),
        ContactNumber::NormalBacklash => of.backlash.as_ref().map(|room| room.normal),
        ContactNumber::Clearance => of.clearances.iter().map(|room| room.least_mm).reduce(f64::min),
        ContactNumber::HalfLength => middle.and_then(|middle| middle.ellipse).map(|[long, _]| long),
        ContactNumber::HalfWidth => middle.and_then(|middle| middle.ellipse).map(|[_, short]| short),
        ContactNumber::GapHigh => middle.and_then(|middle| middle.gap).map(|[high, _]| high),
        ContactNumber::GapLow => middle.and_then(|middle| middle.gap).map(|[_, low]| low),
        ContactNumber::Pairs => of.error.as_ref().map(|error| error.pairs as f64),
        ContactNumber::Z(member) => middle.map(|middle| middle.on[member].z),
        ContactNumber::Rho(member) => middle.map(|middle| middle.on[member].rho),
    }
}
