//! The surfaces of a tooth space as charts whose borders are the lines that they share.

use flank_chain_dsl::{Job, Parameter, Solid};
use flank_expr::VariableId;
use flank_solver::{Blank, Body, BodyFault, Chart, Outcome, SurfacePoint, SurfacePoints};
use nalgebra::Vector3;

use crate::project::failure::Failure;
use crate::project::remark::NotDone;
use crate::project::session::Session;
use crate::solve::blank;
use crate::solve::body::borders::{Beside, Border, Borders};
use crate::solve::body::ends;
use crate::solve::body::piece::{Piece, SAME_LINE, apart, positions};
use crate::solve::body::refusal::{self, refused};
use crate::solve::body::uncut::{self, Nodes, Uncut};

/// How far charts may be off between their points, mm: below what any file or number shows.
const EXACT: f64 = 1e-8;
/// Rows and columns of charts that are tried, each until it suffices.
const COUNTS: [usize; 4] = [9, 17, 33, 65];

/// The surfaces of a space, made into charts of a body.
pub(crate) struct Space {
    pub(crate) body: Body,
    /// The names of its charts, in the order of the solid.
    pub(crate) names: Vec<String>,
    /// How far the charts are off between their points at the most, mm.
    pub(crate) off: f64,
    /// Which of the names have normals that point into the body.
    pub(crate) into_steel: Vec<String>,
    /// The points of each chart of each space that differs from the first one, and of that, in the order of the solid.
    pub(crate) nodes: Vec<Vec<Nodes>>,
    /// What surfaces that are none of the body's trim of it.
    pub(crate) untrimmed: Vec<Uncut>,
}

impl Space {
    /// What tools take away of the body in other positions, and what tells of that and of what trims it.
    ///
    /// # Errors
    /// If the work is cancelled.
    pub(crate) fn uncut(
        &self,
        job: &Job<'_>,
        solid: &Solid,
        session: Session<'_>,
    ) -> Result<(Vec<Uncut>, Vec<NotDone>), Failure> {
        let positions = uncut::in_other_positions(solid, &jobs_of_spaces(job, solid), &self.nodes, session)?;
        let trims = uncut::trims_told(solid, &self.untrimmed).into_iter();
        let told = trims.chain(uncut::positions_told(solid, &positions)).collect();
        Ok((positions, told))
    }
}

/// A chart with its points, and its surface's normal in the middle times the chart's own: negative where they point to different sides.
#[derive(Clone)]
struct Charted {
    chart: Chart,
    /// By which its rows are told apart.
    unknown: usize,
    nodes: Nodes,
    facing: f64,
}

/// The jobs that have solids.
///
/// # Errors
/// If none has.
pub(crate) fn with_solids<'j, 'g>(jobs: &'j [Job<'g>]) -> Result<Vec<&'j Job<'g>>, Failure> {
    let meant: Vec<&Job<'g>> = jobs.iter().filter(|job| !job.solids.is_empty()).collect();
    if meant.is_empty() {
        let names: Vec<String> = jobs.iter().map(|job| format!("`{}`", job.name)).collect();
        return Err(format!("no solid in job {}: `solid NAME in FRAME = turned(…)` makes one", names.join(", ")).into());
    }
    Ok(meant)
}

/// What lies between the borders of a space.
struct Between {
    body: Result<Body, BodyFault>,
    off: f64,
    /// Of the charts in the order in which they are given.
    facing: Vec<f64>,
    /// Of all spaces.
    nodes: Vec<Vec<Nodes>>,
    /// By which the rows of each are told apart.
    unknowns: Vec<Vec<usize>>,
}

/// # Errors
/// If the surfaces of the space are no chain of neighbours from tip to tip, or bound no body.
pub(crate) fn body(job: &Job<'_>, solid: &Solid, session: Session<'_>) -> Result<Space, Failure> {
    let jobs = jobs_of_spaces(job, solid);
    let mut spaces: Vec<Vec<Piece<'_, '_>>> = Vec::new();
    for job in &jobs {
        spaces.push(pieces(job, solid, session, &spaces)?);
    }
    let blank = ends::blank(solid, &spaces[0])?;
    let beside: Vec<Vec<Beside<'_, '_>>> = (0..spaces.len()).map(|k| beside(solid, &spaces, k)).collect();
    let mut borders: Vec<Borders<'_, '_>> = Vec::new();
    for (pieces, beside) in spaces.iter().zip(&beside) {
        session.check()?;
        borders.push(Borders::new(solid, (pieces, beside), &blank, borders.first())?);
    }
    if spaces[0].len() < 2 && !borders[0].has_edge() {
        let message =
            format!("the space of `{}` is one surface: its body needs all of them from tip to tip", solid.name);
        return Err(refused(solid, message, &["name them in their order in `of: […]`, the root among them"]));
    }
    let names: Vec<&str> = spaces[0].iter().map(|piece| piece.surface.name.as_str()).collect();
    // what follows from an outline elsewhere is no reason of its own
    let outside = |failure: Failure| match failure {
        Failure::NotDone(_) => elsewhere(solid, &spaces[0], &blank).unwrap_or(failure),
        _ => failure,
    };
    let faulty = |fault: BodyFault, has_edge: bool| outside(refusal::faulty(solid, (&blank, &names, has_edge), fault));
    let first = between(solid, (&spaces, &borders, &blank), session).map_err(outside)?;
    let (body, off, facing, nodes, unknowns) = match first.body {
        Ok(body) => (body, first.off, first.facing, first.nodes, first.unknowns),
        Err(fault) => {
            let has_edge = borders[0].has_edge();
            let is_pointed = matches!(fault, BodyFault::Pointed { is_whole: true, .. });
            let edges = borders
                .into_iter()
                .zip(&beside)
                .map(|(borders, beside)| borders.meeting_in_an_edge(beside, &blank).filter(|_| is_pointed));
            let borders: Vec<Borders<'_, '_>> = edges.collect::<Option<_>>().ok_or_else(|| faulty(fault, has_edge))?;
            let Between { body, off, facing, nodes, unknowns } = between(solid, (&spaces, &borders, &blank), session)?;
            (body.map_err(|fault| faulty(fault, true))?, off, facing, nodes, unknowns)
        }
    };
    let names: Vec<String> = names.into_iter().map(str::to_string).collect();
    // the rows of a body's charts run so that their normals point out of it
    let turned = if body.is_reversed() { -1.0 } else { 1.0 };
    let into_steel =
        names.iter().zip(&facing).filter(|(_, facing)| turned * **facing < 0.0).map(|(name, _)| name.clone());
    let mut untrimmed: Vec<Uncut> = Vec::new();
    for ((pieces, unknowns), nodes) in spaces.iter().zip(&unknowns).zip(&nodes) {
        session.check()?;
        let of_piece = |k: usize| uncut::by_trims(solid, (&pieces[k], unknowns[k], &blank), &nodes[k], session);
        (0..pieces.len()).flat_map(of_piece).for_each(|more| uncut::add(&mut untrimmed, more));
    }
    Ok(Space { into_steel: into_steel.collect(), names, off, body, nodes, untrimmed })
}

/// That the flanks of a space lie outside the outline, if they do.
fn elsewhere(solid: &Solid, pieces: &[Piece<'_, '_>], blank: &Blank) -> Option<Failure> {
    let places = |piece: &Piece<'_, '_>| {
        piece.known.iter().map(|point| piece.arrangement.section(point.position)).collect::<Vec<[f64; 2]>>()
    };
    let surfaces: Vec<(&str, Vec<[f64; 2]>)> =
        pieces.iter().map(|piece| (piece.surface.name.as_str(), places(piece))).collect();
    refusal::elsewhere(solid, blank, &surfaces)
}

/// The job of each space that differs from the first one, and of that: its parameter says which space it is.
fn jobs_of_spaces<'g>(job: &Job<'g>, solid: &Solid) -> Vec<Job<'g>> {
    let Some(each) = &solid.each else { return vec![job.clone()] };
    let of_space = |space: u32| {
        let mut job = Job { name: format!("{} {each} {space}", job.name), ..job.clone() };
        let mut changed: Vec<VariableId> = Vec::new();
        for at in 0..job.parameters.len() {
            let Parameter { name, variable, definition, .. } = &job.parameters[at];
            let graph = variable.graph();
            // settings of tools and machines follow it, too
            let definition = if name == each {
                graph.constant(f64::from(space))
            } else if graph.variables_of(&[*definition]).iter().any(|of| changed.contains(of)) {
                graph.substitute(&[*definition], &job.bindings())[0]
            } else {
                continue;
            };
            changed.extend(variable.as_variable());
            let parameter = &mut job.parameters[at];
            parameter.value = definition.as_constant().unwrap_or(f64::NAN);
            parameter.definition = definition;
        }
        job
    };
    (0..solid.teeth).map(of_space).collect()
}

fn pieces<'j, 'g>(
    job: &'j Job<'g>,
    solid: &Solid,
    session: Session<'j>,
    before: &[Vec<Piece<'j, 'g>>],
) -> Result<Vec<Piece<'j, 'g>>, Failure> {
    let arrangement = blank::arrangement(solid);
    let piece = |(k, at): (usize, &usize)| {
        let before: Vec<&Piece<'_, '_>> = before.iter().map(|pieces| &pieces[k]).collect();
        Piece::new(job, (solid, &job.surfaces[*at], arrangement), session, &before)
    };
    solid.space.iter().enumerate().map(piece).collect()
}

/// What may lie beside a space: the same space one on, whichever way round they are counted, or the spaces that are counted before and behind it.
fn beside<'j, 'g>(solid: &Solid, spaces: &[Vec<Piece<'j, 'g>>], space: usize) -> Vec<Beside<'j, 'g>> {
    let (count, own) = (spaces.len(), &spaces[space]);
    let ends = |pieces: &[Piece<'j, 'g>]| [pieces[0].clone(), pieces[pieces.len() - 1].clone()];
    let [first, last] = ends(own);
    if solid.each.is_none() {
        let pitch = blank::arrangement(solid).pitch(solid.teeth);
        let moved = |by: f64| [last.clone(), first.moved(by)];
        return [pitch, -pitch].into_iter().map(|by| [moved(by), moved(by)]).collect();
    }
    let [before, behind] = [count - 1, 1].map(|by| ends(&spaces[(space + by) % count]));
    let between = |[_, last_before]: &[Piece<'j, 'g>; 2], [first_behind, _]: &[Piece<'j, 'g>; 2]| {
        [[last_before.clone(), first.clone()], [last.clone(), first_behind.clone()]]
    };
    vec![between(&before, &behind), between(&behind, &before)]
}

/// The body between borders.
fn between(
    solid: &Solid,
    (spaces, borders, blank): (&[Vec<Piece<'_, '_>>], &[Borders<'_, '_>], &Blank),
    session: Session<'_>,
) -> Result<Between, Failure> {
    let last = COUNTS.len() - 1;
    // which of the counts the rows of each surface have, and the columns, which neighbours share
    let (mut rows, mut columns) = (vec![0; spaces[0].len()], 0);
    let mut charts: Vec<Vec<Charted>> = vec![Vec::new(); spaces.len()];
    loop {
        for ((pieces, borders), charts) in spaces.iter().zip(borders).zip(&mut charts) {
            session.check()?;
            let made = |k: usize| {
                let counts = [COUNTS[rows[k]], COUNTS[columns]];
                match charts.get(k) {
                    Some(charted) if charted.chart.counts() == counts => Ok(charted.clone()),
                    Some(charted) => chart((solid, k), (&pieces[k], charted.unknown), (borders, blank), counts),
                    None => first_chart((solid, k), &pieces[k], (borders, blank), counts),
                }
            };
            *charts = (0..pieces.len()).map(made).collect::<Result<_, Failure>>()?;
        }
        let tails: Vec<[f64; 2]> = (0..rows.len())
            .map(|k| charts.iter().map(|charts| charts[k].chart.tails()).fold([0.0; 2], larger))
            .collect();
        let [_, along] = tails.iter().copied().fold([0.0; 2], larger);
        let before = (rows.clone(), columns);
        for (rows, [across, _]) in rows.iter_mut().zip(&tails) {
            *rows = last.min(*rows + usize::from(*across > EXACT));
        }
        columns = last.min(columns + usize::from(along > EXACT));
        if before == (rows.clone(), columns) {
            let off = tails.into_iter().flatten().fold(0.0, f64::max);
            let arrangement = blank::arrangement(solid);
            let facing = charts[0].iter().map(|charted| charted.facing).collect();
            let nodes =
                charts.iter().map(|space| space.iter().map(|charted| charted.nodes.clone()).collect()).collect();
            let unknowns = charts.iter().map(|space| space.iter().map(|charted| charted.unknown).collect()).collect();
            let charts = charts.into_iter().map(|space| space.into_iter().map(|charted| charted.chart).collect());
            let body = Body::new(blank.clone(), (arrangement, solid.teeth), charts.collect(), borders[0].has_edge());
            return Ok(Between { body, off, facing, nodes, unknowns });
        }
    }
}

fn larger(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|k| a[k].max(b[k]))
}

/// The chart of a surface by the first of its unknowns that tells all of its rows apart.
fn first_chart(
    (solid, k): (&Solid, usize),
    piece: &Piece<'_, '_>,
    (borders, blank): (&Borders<'_, '_>, &Blank),
    counts: [usize; 2],
) -> Result<Charted, Failure> {
    let mut first = None;
    for unknown in borders.across(solid, piece, k, blank)? {
        match chart((solid, k), (piece, unknown), (borders, blank), counts) {
            Ok(charted) => return Ok(charted),
            Err(failure @ Failure::NotDone(_)) => first = first.or(Some(failure)),
            Err(failure) => return Err(failure),
        }
    }
    let failure = borders.of_two_unknowns(solid, piece, k).or(first);
    Err(failure.expect("some unknown was tried"))
}

/// The chart of a surface between its borders, whose rows an unknown tells apart.
fn chart(
    (solid, k): (&Solid, usize),
    (piece, unknown): (&Piece<'_, '_>, usize),
    (borders, blank): (&Borders<'_, '_>, &Blank),
    [rows, columns]: [usize; 2],
) -> Result<Charted, Failure> {
    let (shares, along) = (Chart::shares(rows), Chart::shares(columns));
    let end = |side: usize| {
        let shared = borders.border(solid, (k, side), (unknown, blank), &along);
        shared.unwrap_or_else(|| at_tip(solid, piece, (unknown, blank), &along))
    };
    let borders = [end(0)?, end(1)?];
    let ends = borders.each_ref().map(|border| &border.values);
    let value = |i: usize, j: usize| (1.0 - shares[i]) * ends[0][j] + shares[i] * ends[1][j];
    let targets: Vec<[f64; 2]> =
        (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j))).map(|(i, j)| [value(i, j), along[j]]).collect();
    let middle = value(rows / 2, columns / 2);
    let width = (ends[1][columns / 2] - ends[0][columns / 2]).abs();
    let far = |point: &SurfacePoint| {
        (point.unknowns[unknown] - middle).abs() / width + (piece.along_of(blank, point) - 0.5).abs()
    };
    let points = piece.solved(piece.across(unknown, blank), (&targets, [rows, columns]), far);
    all_solved(solid, (piece, "its neighbours and the tip"), &points)?;
    let row = |i: usize| (0..columns).map(move |j| i * columns + j);
    for (border, row) in borders.iter().zip([row(0), row(rows - 1)]) {
        let reached = row.map(|at| points.point(at).position);
        let off = reached.zip(&border.points).map(|(own, there)| apart(own, *there)).fold(0.0, f64::max);
        if off > SAME_LINE {
            return Err(refusal::folded(solid, &piece.surface, unknown, off));
        }
    }
    let chart = Chart::through(positions(&points), [rows, columns]);
    // of odd numbers of rows and columns there is a point in the middle
    let normal = Vector3::from(points.point(rows / 2 * columns + columns / 2).normal);
    let [_, across, far] = chart.frame([0.5; 2]).map(Vector3::from);
    let nodes =
        Nodes { points: (0..points.len()).map(|k| points.point(k)).collect(), targets, counts: [rows, columns] };
    Ok(Charted { facing: normal.dot(&far.cross(&across)), chart, unknown, nodes })
}

/// Where a surface reaches the tip, with the values of an unknown.
fn at_tip(
    solid: &Solid,
    piece: &Piece<'_, '_>,
    (unknown, blank): (usize, &Blank),
    shares: &[f64],
) -> Result<Border, Failure> {
    let targets: Vec<[f64; 2]> = shares.iter().map(|share| blank.tip(*share)).collect();
    let middle = targets[targets.len() / 2];
    let far = |point: &SurfacePoint| {
        let [z, rho] = piece.arrangement.section(point.position);
        (z - middle[0]).hypot(rho - middle[1])
    };
    let points = piece.solved_line(piece.section(), &targets, (unknown, far));
    if points.solved() < shares.len()
        && let Some(end) = end_at_tip(piece, (unknown, blank), shares)
    {
        return Ok(end);
    }
    let tip = format!(
        "`{}` of the outline, where the first surface of a space begins and the last one ends,",
        blank.bounds()[1].name
    );
    all_solved(solid, (piece, &tip), &points).map_err(|failure| {
        let between = format!(
            "name in `of:` the surface between `{}` and the tip, if the tool leaves one there",
            piece.surface.name
        );
        let is_beyond_tool = piece.beyond(&points).iter().any(|(unknown, _)| piece.is_of_tool(*unknown));
        if is_beyond_tool { refusal::with_way(failure, between) } else { failure }
    })?;
    let values = (0..points.len()).map(|k| points.unknowns(k)[unknown]).collect();
    Ok(Border { values, points: positions(&points) })
}

/// The end of an unknown's range at which a surface lies on the tip all along. Where it only touches the tip there, as a rounded edge does
/// that ends in its crest, rounding decides whether it has a point as high as the tip.
fn end_at_tip(piece: &Piece<'_, '_>, (unknown, blank): (usize, &Blank), shares: &[f64]) -> Option<Border> {
    let is_on_tip = |point: &[f64; 3]| blank.above_tip(piece.arrangement.section(*point)).abs() <= EXACT;
    let range = piece.bound().ranges()[unknown];
    [range.low, range.high].into_iter().filter(|end| end.is_finite()).find_map(|end| {
        let points = piece.on_line((unknown, end), blank, shares);
        let border = || Border { values: vec![end; shares.len()], points: positions(&points) };
        (points.solved() == shares.len()).then(border).filter(|border| border.points.iter().all(is_on_tip))
    })
}

/// # Errors
/// With the first point that is not solved, of those with which a surface reaches what is said.
fn all_solved(solid: &Solid, (piece, what): (&Piece<'_, '_>, &str), points: &SurfacePoints) -> Result<(), Failure> {
    let open: Vec<usize> = (0..points.len()).filter(|k| points.outcome(*k) != Outcome::Solved).collect();
    let Some(first) = open.first() else { return Ok(()) };
    let (outcome, ways) = match points.outcome(*first) {
        Outcome::CutAway(_) => ("undercut: the tool cuts them away again".to_string(), Vec::new()),
        Outcome::Outside { .. } => refusal::wider(&piece.surface, &piece.beyond(points)),
        Outcome::Singular => ("singular".to_string(), Vec::new()),
        Outcome::Ambiguous => ("on several branches".to_string(), vec!["a `keep` in its sample".to_string()]),
        _ => ("not found".to_string(), Vec::new()),
    };
    let message = format!(
        "`{}` does not reach {what} in the spaces of `{}`: {} of {} points there are {outcome}",
        piece.surface.name,
        solid.name,
        open.len(),
        points.len()
    );
    Err(refused(solid, message, &ways.iter().map(String::as_str).collect::<Vec<&str>>()))
}
