//! A section through the tooth space, square to the tooth, with the tool at some moments.

use flank_chain_dsl::GeneratedSurface;
use flank_draw::{PictureOptions, Section, SectionCircle, SectionLine, ToolPosition, section};
use flank_export::shape::rows_follow_profile;
use flank_export::{Patch, fixed};
use flank_solver::{Outcome, SectionPlane, SurfacePoint};

use super::maps::{cross, dot, unit};
use super::subject::Subject;
use super::tool::Tool;
use super::{Drawing, Unfit, counted};
use crate::project::units;
use crate::solve::bound;

/// Positions of the tool in all, and of each surface at least.
/// Where teeth are higher along the axis than this share of their height across it, their tips and roots have no circles of their own: those of
/// bevel gears of 84 degrees and less have.
const RADIAL: f64 = 0.1;
const POSITIONS: usize = 14;
const LEAST_POSITIONS: usize = 3;
/// Surfaces at most at which the tool is drawn: in each position all tools are cut, which for each surface would grow with their square.
const MOST_TOUCHED: usize = 14;
/// Below this sine, ten degrees, flanks are too steep to tell tip from root by the side to which they lean.
const STEEP: f64 = 0.17;
/// Points of a surface in the section.
const POINTS: usize = 61;

pub(super) fn draw(subject: &Subject<'_, '_>, options: &PictureOptions) -> Result<Drawing, Unfit> {
    let drawn = across_tooth(subject)?;
    let shows = format!(
        "{} across the tooth, {} of the tool",
        counted(drawn.surfaces.len(), "surface"),
        counted(drawn.tools.len(), "position")
    );
    Ok(Drawing { picture: section(&drawn, options), shows })
}

fn across_tooth(subject: &Subject<'_, '_>) -> Result<Section, Unfit> {
    let cut = Cut::through_middle(subject)?;
    let mates = subject.mates();
    let mut tools = Vec::new();
    for &at in &mates {
        tools.push(Tool::of_surface(subject.job, subject.solved[at].surface)?);
    }
    let line = |&at: &usize| {
        let solved = &subject.solved[at];
        let surface = bound(subject.job, solved.surface);
        cut.0
            .cut(&surface, (&solved.points, solved.counts()), POINTS)
            .expect("a job without errors leaves nothing unbound")
    };
    let lines: Vec<Vec<SurfacePoint>> = mates.iter().map(line).collect();
    if lines.iter().all(Vec::is_empty) {
        return Err("the plane of the section meets no solved point".to_string());
    }
    Ok(Section {
        header: subject.dataset.header.clone(),
        note: cut.note(subject),
        surfaces: mates.iter().zip(&lines).map(|(&at, line)| cut.line(subject.solved[at].surface, line)).collect(),
        circles: cut.circles(subject, &mates, &lines),
        motion: motion(subject),
        tools: cut.positions(subject, &mates, &lines, &tools),
    })
}

/// The first motion of the first surface with its unit.
fn motion(subject: &Subject<'_, '_>) -> String {
    let of = &subject.first().surface.unknowns[2];
    match units::symbol(of.dimension) {
        "" => of.name.clone(),
        unit => format!("{}, {unit}", of.name),
    }
}

/// The plane of the section; its axes go across and up on paper.
struct Cut(SectionPlane);

impl Cut {
    /// The plane through the middle of the first surface, square to the tooth there.
    fn through_middle(subject: &Subject<'_, '_>) -> Result<Cut, Unfit> {
        let (at, point) = subject.middle()?;
        let patch = &subject.dataset.patches[subject.chosen[0]];
        let no_direction =
            || format!("the grid of `{}` does not tell root and tip from the length of the tooth", patch.name);
        let along_rows = rows_follow_profile(patch).ok_or_else(no_direction)?;
        let profile = neighbours(patch, at, along_rows).ok_or_else(no_direction)?;
        let length = neighbours(patch, at, !along_rows).and_then(unit).ok_or_else(no_direction)?;
        // away from the axis in the middle of all that the tool leaves
        let solved = subject.mates().into_iter().flat_map(|mate| &subject.solved[mate].points);
        let solved = solved.filter(|point| point.outcome == Outcome::Solved);
        let near =
            solved.filter(|other| dot(length, [0, 1, 2].map(|k| other.position[k] - point.position[k])).abs() < 1.0);
        let sum = near.fold([0.0; 2], |sum, other| [sum[0] + other.position[0], sum[1] + other.position[1]]);
        let outward = unit([sum[0], sum[1], 0.0]).unwrap_or([1.0, 0.0, 0.0]);
        // in the axial plane from root to tip: the side to which what the tool leaves leans, and where that is steep, away from the axis
        let rise = [0, 1, 2].map(|k| dot(profile, outward) * outward[k] + [0.0, 0.0, profile[2]][k]);
        let in_plane = [0, 1, 2].map(|k| rise[k] - dot(rise, length) * length[k]);
        let up = unit(in_plane).ok_or_else(no_direction)?;
        let lean = Self::lean(subject, point.position, up);
        let way = if lean.abs() < STEEP { dot(up, outward) } else { lean };
        let up = if way < 0.0 { up.map(|x| -x) } else { up };
        Ok(Cut(SectionPlane { point: point.position, normal: length, axes: [cross(up, length), up] }))
    }

    /// How far the normals of all that the tool leaves point in a direction, each where it is nearest to a place.
    fn lean(subject: &Subject<'_, '_>, place: [f64; 3], direction: [f64; 3]) -> f64 {
        let off = |point: &SurfacePoint| (0..3).map(|k| (point.position[k] - place[k]).powi(2)).sum::<f64>();
        let nearest = |at: usize| {
            let solved = subject.solved[at].points.iter().filter(|point| point.outcome == Outcome::Solved);
            solved.min_by(|a, b| off(a).total_cmp(&off(b)))
        };
        subject.mates().into_iter().filter_map(nearest).map(|point| dot(direction, point.normal)).sum()
    }

    fn note(&self, subject: &Subject<'_, '_>) -> String {
        let [x, y, z] = self.0.point;
        let is_counted = subject.motions().iter().any(|motion| motion.is_count);
        let counts = if is_counted { "; what counts is taken without gaps" } else { "" };
        let mates = subject.mates();
        let others = (0..subject.solved.len()).filter(|at| !mates.contains(at));
        let touched = match mates.len() {
            count if count > MOST_TOUCHED => {
                format!(" The tool is drawn where it makes {MOST_TOUCHED} of {count} surfaces.")
            }
            _ => String::new(),
        };
        let others: Vec<&str> = others.map(|at| subject.solved[at].surface.name.as_str()).collect();
        let others = match others[..] {
            [] => String::new(),
            _ => format!(" Not drawn, being of another tool, other motions or another frame: {}.", others.join(", ")),
        };
        format!(
            "Plane square to the tooth through the middle of {}, at radius {} mm and z {} mm; exact points, strokes on the \
             side of the steel, dots where the tool touches at that moment{counts}.{touched}{others}",
            subject.first().surface.name,
            fixed(x.hypot(y), 3),
            fixed(z, 3)
        )
    }

    fn line(&self, surface: &GeneratedSurface<'_>, points: &[SurfacePoint]) -> SectionLine {
        let normal = |point: &SurfacePoint| self.0.axes.map(|axis| dot(axis, point.normal));
        SectionLine {
            name: surface.name.clone(),
            points: points.iter().map(|point| self.0.in_axes(point.position)).collect(),
            normals: points.iter().map(normal).collect(),
        }
    }

    /// Circles about the axis through the highest and the deepest point of the lines; none where teeth stand along the axis, as those of face
    /// gears do: there both circles would lie beside each other, and neither is that of tips or roots.
    fn circles(&self, subject: &Subject<'_, '_>, mates: &[usize], lines: &[Vec<SurfacePoint>]) -> Vec<SectionCircle> {
        let points = mates.iter().zip(lines).flat_map(|(at, line)| line.iter().map(move |point| (*at, point)));
        let places: Vec<(usize, [f64; 2])> = points.map(|(at, point)| (at, self.0.in_axes(point.position))).collect();
        let ends = |k: usize| {
            let all = || places.iter().map(|(_, place)| place[k]);
            [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
        };
        let across = ends(0);
        let [low, high] = ends(1);
        let rho = |up: f64| {
            let (_, place) = places.iter().find(|(_, place)| place[1] == up)?;
            let [x, y, _] = self.position(*place);
            Some(x.hypot(y))
        };
        if rho(high).zip(rho(low)).is_some_and(|(high_rho, low_rho)| (high_rho - low_rho).abs() < RADIAL * (high - low))
        {
            return Vec::new();
        }
        [("tip circle", high), ("root circle", low)]
            .into_iter()
            .filter_map(|(name, up)| {
                let (at, place) = places.iter().find(|(_, place)| place[1] == up)?;
                let cone = self.cone(&subject.dataset.patches[*at], *place)?;
                let wide = 0.2 * (across[1] - across[0]);
                let step = |k: i32| across[0] - wide + (across[1] - across[0] + 2.0 * wide) * f64::from(k) / 40.0;
                let line = (0..=40).filter_map(|k| self.on_cone(cone, [step(k), place[1]]));
                let rho = cone[0] + cone[1] * self.position(*place)[2];
                Some(SectionCircle {
                    name: format!("{name}, Ø {} mm", fixed(2.0 * rho, 3)),
                    is_above: up == high,
                    points: line.collect(),
                })
            })
            .collect()
    }

    fn position(&self, [across, up]: [f64; 2]) -> [f64; 3] {
        let SectionPlane { point, axes, .. } = &self.0;
        [0, 1, 2].map(|k| point[k] + across * axes[0][k] + up * axes[1][k])
    }

    /// The cone through a place of the section that a patch runs along there: `rho` at z 0, and its rise by z.
    fn cone(&self, patch: &Patch, place: [f64; 2]) -> Option<[f64; 2]> {
        let along_rows = rows_follow_profile(patch)?;
        let [rows, columns] = [patch.rows.count, patch.columns.count];
        let (lines, length) = if along_rows { (rows, columns) } else { (columns, rows) };
        let point = |line: usize, k: usize| {
            let found = if along_rows { patch.point(line, k) } else { patch.point(k, line) };
            found.filter(|point| point.is_solved()).map(|point| point.position)
        };
        let here = self.position(place);
        let off = |line: &usize| {
            let apart = |k: usize| point(*line, k).map(|at| (0..3).map(|k| (at[k] - here[k]).powi(2)).sum::<f64>());
            (0..length).filter_map(apart).fold(f64::INFINITY, f64::min)
        };
        let line = (0..lines).min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let mut known = (0..length).filter_map(|k| point(line, k));
        let from = known.next()?;
        let to = known.next_back().unwrap_or(from);
        let rho = |[x, y, _]: [f64; 3]| x.hypot(y);
        let rise = if (to[2] - from[2]).abs() > 1e-9 { (rho(to) - rho(from)) / (to[2] - from[2]) } else { 0.0 };
        rise.is_finite().then(|| [rho(here) - rise * here[2], rise])
    }

    /// The point of the plane on a cone above or below a place, by Newton's method.
    fn on_cone(&self, [rho, rise]: [f64; 2], [across, mut up]: [f64; 2]) -> Option<[f64; 2]> {
        let height = |up: f64| {
            let [x, y, z] = self.position([across, up]);
            x.hypot(y) - rho - rise * z
        };
        for _ in 0..20 {
            let by = 1e-6;
            let step = height(up) * by / (height(up + by) - height(up));
            up -= step;
            if step.abs() < 1e-9 {
                return Some([across, up]);
            }
        }
        None
    }

    /// The tool where it touches at points spread evenly over each line, in the order of the first motion.
    fn positions(
        &self,
        subject: &Subject<'_, '_>,
        mates: &[usize],
        lines: &[Vec<SurfacePoint>],
        tools: &[Tool],
    ) -> Vec<ToolPosition> {
        let each = (POSITIONS / mates.len()).max(LEAST_POSITIONS);
        let mut positions: Vec<(f64, ToolPosition)> = Vec::new();
        let touched: Vec<(&usize, &Vec<SurfacePoint>)> =
            mates.iter().zip(lines).filter(|(_, line)| !line.is_empty()).collect();
        let drawn = touched.len().min(MOST_TOUCHED);
        for (&at, line) in (0..drawn).map(|k| touched[k * touched.len() / drawn]) {
            let surface = subject.solved[at].surface;
            for k in 0..each {
                let touching = &line[(2 * k + 1) * line.len() / (2 * each)];
                let rest = &touching.unknowns[2..];
                let pieces = tools.iter().flat_map(|tool| tool.cut(rest, &self.0));
                let position = ToolPosition {
                    value: units::shown(surface.unknowns[2].dimension, rest[0]),
                    lines: pieces.map(|ends| ends.map(|end| self.0.in_axes(end)).to_vec()).collect(),
                    contacts: vec![self.0.in_axes(touching.position)],
                };
                positions.push((rest[0], position));
            }
        }
        positions.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        positions.into_iter().map(|(_, position)| position).collect()
    }
}

/// From the grid's point before one to the one behind it, as far as they are solved.
fn neighbours(patch: &Patch, at: usize, along_rows: bool) -> Option<[f64; 3]> {
    let columns = patch.columns.count;
    let (i, j) = (at / columns, at % columns);
    let near = |step: isize| {
        let (di, dj) = if along_rows { (step, 0) } else { (0, step) };
        let point = patch.point(i.checked_add_signed(di)?, j.checked_add_signed(dj)?)?;
        point.is_solved().then_some(point.position)
    };
    let here = patch.points[at].position;
    let (before, after) = (near(-1).unwrap_or(here), near(1).unwrap_or(here));
    let way = [0, 1, 2].map(|k| after[k] - before[k]);
    (dot(way, way) > 0.0).then_some(way)
}

#[cfg(test)]
mod tests {
    use flank_expr::Graph;

    use super::*;
    use std::sync::Arc;

    use crate::project::Project;
    use crate::project::choices::PlotKind;
    use crate::project::monitor::Unwatched;
    use crate::project::requests::JobSelection;
    use crate::project::session::{EvaluatorOptions, Session};
    use crate::project::spec;
    use crate::solve;

    type Place = [f64; 2];

    fn section_of(spec: &str) -> Section {
        let file = format!("{}/../../specs/{spec}.chain", env!("CARGO_MANIFEST_DIR"));
        let which = JobSelection::all(Project::open(file, Arc::new(flank_chain_dsl::Disk)));
        let graph = Graph::new();
        let (_, jobs) = spec::jobs(&graph, &which, &Unwatched).expect("it is shipped");
        let header = solve::header(&[&jobs[0]], &which, &spec::Origin::default());
        let session = Session::new(EvaluatorOptions::default(), &Unwatched);
        let subject = Subject::new(&jobs[0], &[], header, &[PlotKind::Section], session).expect("it is sampled");
        across_tooth(&subject).expect("it has a section")
    }

    /// How far a place is off the nearest point of a piece, and on which side of it: the sine of the way there against `out`.
    fn from_piece(place: Place, from: Place, to: Place, out: Place) -> (f64, f64) {
        let way = [to[0] - from[0], to[1] - from[1]];
        let off = [place[0] - from[0], place[1] - from[1]];
        let length = way[0].hypot(way[1]).max(1e-12);
        let along = ((off[0] * way[0] + off[1] * way[1]) / (length * length)).clamp(0.0, 1.0);
        let rest = [off[0] - along * way[0], off[1] - along * way[1]];
        (rest[0].hypot(rest[1]), (rest[0] * out[0] + rest[1] * out[1]) / out[0].hypot(out[1]))
    }

    /// What the section leaves out is named in its caption.
    #[test]
    fn surfaces_of_other_tools_are_named() {
        let note = section_of("bevel/hypoid_pinion").note;
        let left_out =
            "Not drawn, being of another tool, other motions or another frame: convex, convex_fillet, convex_root.";
        assert!(note.ends_with(left_out), "{note}");
        assert!(!section_of("hobbing/spur_gear").note.contains("Not drawn"));
    }

    /// The tool passes through the points in which it touches, and nowhere deeper into the steel than the chords of both lines
    /// are off their arcs: sixty to a flank, and pieces of 1.4 deg on a cutter of 96 mm.
    #[test]
    fn the_tool_touches_and_does_not_cut_in() {
        for spec in ["hobbing/spur_gear", "hobbing/helical_gear", "bevel/pinion_19x62"] {
            let section = section_of(spec);
            assert!(section.tools.len() >= 12 && section.surfaces.iter().all(|line| line.points.len() > 50), "{spec}");
            for tool in &section.tools {
                let pieces = || tool.lines.iter().map(|line| (line[0], line[1]));
                for contact in &tool.contacts {
                    let near = pieces().map(|(from, to)| from_piece(*contact, from, to, [0.0, 1.0]).0);
                    let near = near.fold(f64::INFINITY, f64::min);
                    assert!(near < 2e-3, "{spec}, {}: the tool is {near} mm from where it touches", tool.value);
                }
                let ends = pieces().flat_map(|(from, to)| [from, to]);
                for end in ends {
                    let sides = section.surfaces.iter().flat_map(|line| {
                        let pairs = line.points.windows(2).zip(line.normals.windows(2));
                        pairs.map(move |(pair, normals)| from_piece(end, pair[0], pair[1], normals[0]))
                    });
                    let nearest = sides.min_by(|a, b| a.0.total_cmp(&b.0)).expect("there are surfaces");
                    // beyond the ends of the lines nothing is known
                    if nearest.0 < 0.5 && nearest.1.abs() > 0.99 * nearest.0 {
                        assert!(nearest.1 > -2e-3, "{spec}, {}: {} mm deep at {end:?}", tool.value, nearest.1);
                    }
                }
            }
        }
    }
}
