//! `flank contact`

pub(crate) mod backlash;
mod composite;
pub(crate) mod drawn;
mod edge_places;
pub(crate) mod family;
pub(crate) mod files;
mod fouling;
mod gap;
pub(crate) mod influence;
pub(crate) mod interference;
mod law;
mod least_room;
pub(crate) mod milled;
pub(crate) mod pair;
pub(crate) mod patches;
pub(crate) mod pattern;
pub(crate) mod picture;
pub(crate) mod place;
mod proof;
pub(crate) mod result;
pub(crate) mod rolling;
mod sampled;
pub(crate) mod summary;
pub(crate) mod tester;
mod text;

use std::time::Instant;

use flank_chain_dsl::{Contact, Job};
use flank_draw::DrawnContact;
use flank_export::Header;
use flank_expr::Graph;
use flank_solver::{NoContact, RollingPair};

use self::milled::MilledPair;
use self::pair::Members;
use self::pattern::GapMap;
use self::result::ContactResult;
use self::rolling::Rolling;
use self::summary::Summary;
use crate::convert::milling::flank::MilledFlank;
use crate::project::answer::Timing;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::{NotDone, NotDoneKind, Remark, RemarkKind};
use crate::project::requests::ContactRequest;
use crate::project::session::Session;
use crate::project::spec;
use crate::project::spec::Origin;
use crate::solve;

/// Solves the contacts of jobs: where their flanks touch while they roll, how evenly they turn each other, and what the marking compound
/// shows. `each` is given the result of each contact.
///
/// # Errors
/// What is wrong with the spec, that it has no such contact, that an error names no axis of the pair, or that a file cannot be written.
pub fn contact(
    request: &ContactRequest,
    monitor: &dyn Monitor,
    each: &mut dyn FnMut(ContactResult),
) -> Result<(), Failure> {
    let start = Instant::now();
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let session = Session::new(request.evaluator, monitor).with_points_alone();
    for (job, contact) in asked(&jobs, request)? {
        let result = of_contact(job, contact, request, &origin, session)?;
        each(ContactResult { timing: Timing { elapsed: start.elapsed(), ..result.timing }, ..result });
    }
    Ok(())
}

/// The contacts that are asked for, each with its job.
///
/// # Errors
/// If there is none, or none of that name.
fn asked<'j, 'g>(
    jobs: &'j [Job<'g>],
    request: &ContactRequest,
) -> Result<Vec<(&'j Job<'g>, &'j Contact<'g>)>, Failure> {
    let all: Vec<(&Job<'g>, &Contact<'g>)> =
        jobs.iter().flat_map(|job| job.contacts.iter().map(move |contact| (job, contact))).collect();
    if all.is_empty() {
        let message = "no job says which flanks touch: add `contact drive_side = A with B, over: MOTION, for: UNKNOWN` to one that mounts \
                       both on a pair of shafts";
        return Err(Failure::from(message.to_string()));
    }
    let Some(name) = &request.contact else { return Ok(all) };
    let known: Vec<String> = all.iter().map(|(_, contact)| format!("`{}`", contact.name)).collect();
    let found: Vec<_> = all.into_iter().filter(|(_, contact)| contact.name == *name).collect();
    if found.is_empty() {
        return Err(Failure::from(format!("there is no contact `{name}`; there is: {}", known.join(", "))));
    }
    Ok(found)
}

fn of_contact(
    job: &Job<'_>,
    contact: &Contact<'_>,
    request: &ContactRequest,
    origin: &Origin,
    session: Session,
) -> Result<ContactResult, Failure> {
    let errors = influence::mounting(job, contact, &request.errors)?;
    let mut members = Members::solved(job, contact, session)?;
    members.check_range(job)?;
    let _working = session.begin(format!("rolling {}", contact.name))?;
    let steps = request.positions as usize;
    let rolling = match Rolling::of_members(job, &mut members, &errors, steps) {
        Ok(rolling) => rolling.closely(&members),
        Err(why) => {
            let summary = Summary::new(job, &members, request, &errors);
            let refused = origin.located(&[job], vec![refused(&members, why)]);
            return Ok(ContactResult { not_done: refused, ..summary.of_nothing() });
        }
    };
    session.check()?;
    let summary = Summary::new(job, &members, request, &errors);
    let pair = members.pair(job, &errors, &[]);
    let patterns = pattern::on_both(&members, &pair, &rolling, request.compound);
    session.check()?;
    let influences = if request.sensitivity {
        influence::of_all(job, &members, &errors, &rolling, request.compound)
    } else {
        Vec::new()
    };
    let vhj = if request.vhj { tester::vhj(job, &members, &errors, &rolling) } else { Vec::new() };
    let unmounted = (request.vhj && vhj.is_empty()).then(|| tester::nothing(&members, &rolling));
    let (backlash, unsound) = backlash::of(job, &members, request, &errors, &rolling, session)?;
    let (jams, unsound): (Vec<NotDone>, Vec<NotDone>) =
        unsound.into_iter().partition(|of| of.kind == NotDoneKind::Penetration);
    let rooms = interference::of_spaces(job, &members, &errors, &rolling, session)?;
    let (proven, open) = if request.certify {
        let (proven, open) = proof::of_engagement(&members, &rolling);
        (Some(proven), open)
    } else {
        (None, Vec::new())
    };
    let shown = drawn::drawn(job, &members, (&pair, &rolling), &patterns, request.compound);
    let header = solve::header(&[job], &request.jobs, origin);
    let (milled, unmilled) = milled_beside(job, &members, (&pair, &rolling), (request, &shown, header, session))?;
    let jammed = milled.as_ref().zip(backlash.as_ref()).and_then(|(milled, (own, opposite))| {
        let ahead = milled.ahead.iter().copied();
        let found = opposite.least_ahead(&members, &rolling, ahead)?;
        // what the generated pair does is told of it
        found
            .missed(&members, &format!(" as {} mills it", milled.result.milling))
            .filter(|_| own.missed(&members, "").is_none())
    });
    let jams: Vec<NotDone> = jams.into_iter().chain(jammed).collect();
    // one flank of a pair without backlash rolls wrongly mounted, too
    let is_misplaced = errors.iter().any(|error| *error != 0.0);
    let (jams, noted) = if is_misplaced { (Vec::new(), jams) } else { (jams, Vec::new()) };
    let noted = noted.into_iter().map(|of| {
        let NotDone { of, message, .. } = of;
        Remark::new(RemarkKind::NegativeBacklash, &of.unwrap_or_default(), message)
    });
    let noted: Vec<Remark> = noted.collect();
    let (files, grids) = files::write(
        job,
        &members,
        &rolling,
        (&patterns, shown, milled.as_ref()),
        &errors,
        (request, origin, session),
    )?;
    let result = summary.of_rolling(&rolling, &patterns);
    Ok(ContactResult {
        milled: milled.map(|milled| milled.result),
        influences,
        vhj,
        backlash: backlash.map(|(backlash, _)| backlash),
        clearances: rooms.clearances,
        proven,
        files,
        grids,
        not_done: origin
            .located(&[job], [&result.not_done[..], &unsound, &rooms.not_done, &open, &unmilled, &jams].concat()),
        remarks: origin.located(&[job], [&result.remarks[..], &rooms.remarks, &noted, unmounted.as_slice()].concat()),
        ..result
    })
}

/// The pair with the milled flank that is asked for, or why that is not milled.
///
/// # Errors
/// If there is no such milling, it mills neither flank of the contact, or the work is cancelled.
fn milled_beside<'j, 'g>(
    job: &'j Job<'g>,
    members: &Members<'j, 'g>,
    (pair, rolling): (&RollingPair<'_, 'g>, &Rolling),
    (request, shown, header, session): (&ContactRequest, &DrawnContact, Header, Session<'_>),
) -> Result<(Option<MilledPair>, Vec<NotDone>), Failure> {
    let Some(name) = &request.milled else { return Ok((None, Vec::new())) };
    let known = || job.millings.iter().map(|milling| format!("`{}`", milling.name)).collect::<Vec<String>>().join(", ");
    let found = job.millings.iter().find(|milling| milling.name == *name);
    let milling = found.ok_or_else(|| {
        Failure::from(match job.millings.is_empty() {
            true => format!(
                "job {} mills nothing: add `mill {name} of SURFACE with CUTTER.cutting in MACHINE.work {{ … }}`",
                job.name
            ),
            false => format!("there is no milling `{name}`; there is: {}", known()),
        })
    })?;
    let surface = &job.surfaces[milling.surface].name;
    let Some(member) = (0..2).find(|member| members.surfaces[*member].name == *surface) else {
        let [first, second] = members.surfaces.map(|surface| &surface.name);
        return Err(Failure::from(format!(
            "{name} mills {surface}, and contact {} is one of {first} with {second}",
            members.contact.name
        )));
    };
    let planned = MilledFlank::planned(job, milling, (&request.jobs, session))?;
    session.check()?;
    Ok(match planned {
        Ok(flank) => {
            let _working = session.begin(format!("rolling {} as {name} mills it", members.contact.name))?;
            let film = request.compound;
            let milled = milled::rolled((members, member), (pair, rolling), (&flank, name), (film, shown, header));
            (Some(milled), flank.not_done)
        }
        Err(missing) => (None, missing),
    })
}

/// A contact as it rolls, without files.
pub(crate) struct Rolled<'j, 'g> {
    pub(crate) result: ContactResult,
    pub(crate) members: Members<'j, 'g>,
    /// The roll, and what the marking compound shows on each flank; `None` where they do not touch, which the result says.
    pub(crate) found: Option<(Rolling, Vec<GapMap>)>,
}

/// Rolls a contact as it is mounted.
///
/// # Errors
/// If a flank is not sampled, the range of the unknown holds two teeth, or the work is cancelled.
pub(crate) fn rolled<'j, 'g>(
    job: &'j Job<'g>,
    contact: &'j Contact<'g>,
    request: &ContactRequest,
    session: Session,
) -> Result<Rolled<'j, 'g>, Failure> {
    let errors = influence::mounting(job, contact, &request.errors)?;
    let (members, rolling) = rolling(job, contact, (request, &errors), session)?;
    Ok(match rolling {
        Ok(rolling) => {
            let pair = members.pair(job, &errors, &[]);
            let maps = pattern::on_both(&members, &pair, &rolling, request.compound);
            let result = Summary::new(job, &members, request, &errors).of_rolling(&rolling, &maps);
            Rolled { result, members, found: Some((rolling, maps)) }
        }
        Err(result) => Rolled { result: *result, members, found: None },
    })
}

/// The numbers of a contact as it is mounted, without what the marking compound shows and which edges carry; its members and the roll.
///
/// # Errors
/// As for [`rolled`].
pub(crate) fn numbers<'j, 'g>(
    job: &'j Job<'g>,
    contact: &'j Contact<'g>,
    request: &ContactRequest,
    session: Session,
) -> Result<(ContactResult, Members<'j, 'g>, Option<Rolling>), Failure> {
    let errors = influence::mounting(job, contact, &request.errors)?;
    let (members, rolling) = rolling(job, contact, (request, &errors), session)?;
    Ok(match rolling {
        Ok(rolling) => (Summary::new(job, &members, request, &errors).in_numbers(&rolling), members, Some(rolling)),
        Err(result) => (*result, members, None),
    })
}

/// A contact with these mounting errors as it rolls, or what is told of one that does not touch.
fn rolling<'j, 'g>(
    job: &'j Job<'g>,
    contact: &'j Contact<'g>,
    (request, errors): (&ContactRequest, &[f64]),
    session: Session,
) -> Result<(Members<'j, 'g>, Result<Rolling, Box<ContactResult>>), Failure> {
    let mut members = Members::solved(job, contact, session)?;
    members.check_range(job)?;
    let rolling = match Rolling::of_members(job, &mut members, errors, request.positions as usize) {
        Ok(rolling) => Ok(rolling.closely(&members)),
        Err(why) => {
            let nothing = Summary::new(job, &members, request, errors).of_nothing();
            Err(Box::new(ContactResult { not_done: vec![refused(&members, why)], ..nothing }))
        }
    };
    session.check()?;
    Ok((members, rolling))
}

/// A contact for what writes no files of its own: what is known of it, and what pictures show of it if the flanks touch.
///
/// # Errors
/// If an error names no axis of the pair; see [`rolled`].
pub(crate) fn shown(
    job: &Job<'_>,
    contact: &Contact<'_>,
    request: &ContactRequest,
    session: Session,
) -> Result<(ContactResult, Option<DrawnContact>), Failure> {
    let errors = influence::mounting(job, contact, &request.errors)?;
    let Rolled { result, members, found } = rolled(job, contact, request, session)?;
    let Some((rolling, patterns)) = found else { return Ok((result, None)) };
    let influences = if request.sensitivity {
        influence::of_all(job, &members, &errors, &rolling, request.compound)
    } else {
        Vec::new()
    };
    let pair = members.pair(job, &errors, &[]);
    let drawn = drawn::drawn(job, &members, (&pair, &rolling), &patterns, request.compound);
    Ok((ContactResult { influences, ..result }, Some(drawn)))
}

/// Why two flanks do not touch, with a way out.
fn refused(members: &Members<'_, '_>, why: NoContact) -> NotDone {
    let [first, second] = members.surfaces.map(|surface| &surface.name);
    let Contact { name, roll, lag, .. } = members.contact;
    let (message, ways) = match why {
        NoContact::Apart => (
            format!("{first} and {second} do not reach each other within the range of `{}`", lag.name),
            vec![
                format!(
                    "the sampled points of {first} are met by {second} at no value of `{}` between its ends, at no position of `{}`; widen the \
                     range, or sample the flanks where they face each other",
                    lag.name, roll.name
                ),
                "where they stay apart, mount them nearer; where the members reach into each other all the way, set them apart".to_string(),
                match members.solids[1] {
                    Some(_) => {
                        "the law has to be right to a pitch: of the second member the tooth of the spec and the ones beside it are tried"
                            .to_string()
                    }
                    None => format!(
                        "the law has to be right to the range of `{}`: no `solid` says how many teeth {second} is one of, so the tooth of the spec \
                         alone is tried; with one the teeth beside it are, too",
                        lag.name
                    ),
                },
            ],
        ),
        NoContact::NoFlank(member) => {
            let solid = members.solids[member].map_or(String::new(), |solid| solid.name.clone());
            let surface = &members.surfaces[member].name;
            (
                format!("the outline of {solid} leaves no sampled point of {surface}"),
                vec!["the points `[z, rho]` of its profile are those of the frame in which the solid stands".to_string()],
            )
        }
        NoContact::SameSide => (
            format!("{first} and {second} face the same way where they meet"),
            vec!["one member lies inside the other, or it is the wrong flank of a tooth: its opposite flank faces the mate".to_string()],
        ),
        NoContact::Locked => (
            format!("`{}` moves nothing along the normal: the pair is self-locking there", lag.name),
            vec!["the unknown has to turn or shift a member towards its mate".to_string()],
        ),
        NoContact::Endless => (
            format!("{first} and {second} touch along a line, and nothing says where it ends"),
            vec![
                "say with a `solid` of one member where its teeth end".to_string(),
                "or sample a flank on a grid whose corners lie around it: a line of contact ends where the sample does".to_string(),
            ],
        ),
        NoContact::NotFound => (
            format!("{first} and {second} meet, but no place was found at which they touch"),
            vec!["sample both flanks more densely, or roll the pair to where they face each other".to_string()],
        ),
    };
    NotDone::new(NotDoneKind::NoContact, first, format!("contact {name}: {message}")).with(ways)
}
