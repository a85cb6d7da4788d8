//! `flank report`

mod contacts;
mod conventions;
mod ends;
mod extremes;
mod gear;
mod influences;
mod inputs;
mod machines;
mod millings;
mod pictures;
pub(crate) mod result;
mod results;
mod solids;
mod target;
mod unchecked;

use flank_chain_dsl::{Job, Sources};
use flank_draw::{
    Block, DrawnContact, Figure, MillingDrawing, PictureOptions, Report as Document, ReportSection, Tone,
};
use flank_export::Header;
use flank_expr::Graph;
use flank_solver::TOLERANCE;

use crate::compare::trace_result::FlankTraces;
use crate::contact::{self, result::ContactResult};
use crate::convert::milling::{drawn, result::MillResult};
use crate::draw::{self, Drawing, Subject};
use crate::project::choices::PlotKind;
use crate::project::failure::Failure;
use crate::project::monitor::Monitor;
use crate::project::remark::NotDone;
use crate::project::requests::{ContactRequest, MillRequest, ReportRequest};
use crate::project::session::{Session, check};
use crate::project::spec;
use crate::project::spec::Origin;
use crate::solve::certify;
use crate::solve::cut;
use crate::solve::limits::{self, Line};
use crate::solve::required;
use crate::solve::solved::Solved;
use crate::solve::step::{self, Smooth};
use crate::solve::stream;
use crate::solve::table;
use crate::solve::travel::{self, Run};
use crate::solve::{self, SolveOptions};
use result::{NotChecked, ReportResult, ReportedPicture};
use target::Target;

/// Writes all that is known of jobs, a page each, and gives `each` their results.
///
/// # Errors
/// What is wrong with the spec, that no job asks for points, that there are too many to keep, or that a file cannot be written.
pub fn report(
    request: &ReportRequest,
    monitor: &dyn Monitor,
    each: &mut dyn FnMut(ReportResult),
) -> Result<(), Failure> {
    Target::check(request)?;
    let graph = Graph::new();
    let (compilation, jobs) = spec::jobs(&graph, &request.jobs, monitor)?;
    let origin = Origin::of_compilation(&compilation);
    let jobs = solve::asked((&jobs, &origin), monitor)?;
    let target = Target::of_request(request, &jobs)?;
    for job in jobs {
        let findings = Findings::of_job(job, &compilation.sources, &origin, (request, monitor))?;
        let document = findings.document();
        check(monitor)?;
        let written = target.write(&findings, &document, monitor)?;
        each(findings.result(&document, written));
    }
    Ok(())
}

/// All that was found out about a job.
struct Findings<'j, 'g> {
    job: &'j Job<'g>,
    sources: &'j Sources,
    origin: &'j Origin,
    request: &'j ReportRequest,
    monitor: &'j dyn Monitor,
    header: Header,
    subject: Subject<'j, 'g>,
    /// Where surfaces and contact end.
    lines: Vec<Line<'j, 'g>>,
    runs: Vec<Run<'j, 'g>>,
    /// The pictures that matter for the job.
    drawings: Vec<(PlotKind, Drawing)>,
    /// Of a STEP file, if one is asked for.
    faces: Vec<Smooth>,
    is_certified: bool,
    contacts: Vec<ShownContact>,
    millings: Vec<ShownMilling>,
    gears: Vec<gear::Gear<'j>>,
    /// Of involute flanks.
    traces: Vec<FlankTraces>,
}

/// What is known of a contact, and what pictures show of it.
type ShownContact = (ContactResult, Option<DrawnContact>);

/// What is known of a milling, and what a picture shows of it.
type ShownMilling = (MillResult, Option<MillingDrawing>);

impl<'j, 'g> Findings<'j, 'g> {
    fn of_job(
        job: &'j Job<'g>,
        sources: &'j Sources,
        origin: &'j Origin,
        (request, monitor): (&'j ReportRequest, &'j dyn Monitor),
    ) -> Result<Self, Failure> {
        let wanted = SolveOptions {
            geometry: true,
            sensitivity: true,
            certificates: request.certify,
            together: None,
            arrays: false,
            of_shown: true,
            session: Session::new(request.evaluator, monitor),
        };
        stream::check_kept(job, &job.surfaces, wanted)?;
        let solved = job.surfaces.iter().filter_map(|surface| solve::solve_surface(job, surface, wanted));
        let mut solved: Vec<Solved<'j, 'g>> = solved.collect::<Result<_, _>>()?;
        let mut lines = limits::lines(job, solved.iter().map(|solved| solved.surface), wanted.session)?;
        lines
            .extend(solved.iter_mut().flat_map(|solved| solved.trims.drain(..)).filter(|line| !line.points.is_empty()));
        // those of a surface one after the other
        let place = |line: &Line<'_, '_>| job.surfaces.iter().position(|surface| surface.name == line.surface.name);
        lines.sort_by_key(place);
        let bare = SolveOptions { geometry: false, sensitivity: false, certificates: false, ..wanted };
        let smooth = |tolerance| solved.iter().map(move |solved| step::smooth(job, solved, tolerance, bare));
        let faces = request.step.into_iter().flat_map(smooth).collect::<Result<_, Failure>>()?;
        let runs = travel::runs(job, &solved);
        let header = solve::header(&[job], &request.jobs, origin);
        // the page says once where all its pictures come from
        let unsigned = Header { spec: String::new(), ..header.clone() };
        let of_contacts = ContactRequest { sensitivity: true, ..ContactRequest::new(request.jobs.clone()) };
        let shown = |contact| contact::shown(job, contact, &of_contacts, wanted.session);
        let contacts = job.contacts.iter().map(shown).collect::<Result<_, Failure>>()?;
        let to_mill = MillRequest::new(request.jobs.clone());
        let shown = |milling| drawn::shown(job, milling, &to_mill, (unsigned.clone(), wanted.session));
        let millings = job.millings.iter().map(shown).collect::<Result<_, Failure>>()?;
        let subject = Subject::of_solved(job, solved, &[], unsigned, wanted.session)?;
        let drawings = draw::defaults(&subject, PictureOptions::default());
        let gears = gear::gears(&subject)?;
        let traces = draw::traces::of_subject(&subject).unwrap_or_default();
        Ok(Findings {
            job,
            sources,
            origin,
            request,
            monitor,
            header,
            subject,
            lines,
            runs,
            drawings,
            faces,
            is_certified: request.certify,
            contacts,
            millings,
            gears,
            traces,
        })
    }

    /// A message with its options as readers of the page spell them.
    fn spelled(&self, message: &str) -> String {
        self.monitor.spelled(message)
    }

    fn solved(&self) -> &[Solved<'j, 'g>] {
        &self.subject.solved
    }

    /// What was asked for and not found.
    fn failures(&self) -> Vec<NotDone> {
        let solved = self.solved();
        let mut all = table::failures((self.job, Some(self.origin)), solved);
        all.extend(cut::unknown(solved.iter().map(Solved::left)));
        all.extend(certify::failed(solved));
        all.extend(travel::beyond(self.job, solved));
        all.extend(self.gears.iter().flat_map(|gear| gear.uncut.iter().cloned()));
        all.extend(self.contacts.iter().flat_map(|(contact, _)| contact.not_done.iter().cloned()));
        all.extend(self.millings.iter().flat_map(|(milling, _)| milling.not_done.iter().cloned()));
        all.extend(step::missed(&self.faces, self.request.step.unwrap_or_default()));
        all
    }

    /// Points that were asked for, and of them those that were solved.
    fn counts(&self) -> [usize; 2] {
        let all = self.solved().iter().map(|solved| [solved.summary.asked, solved.summary.solved()]);
        all.fold([0; 2], |[asked, found], [a, f]| [asked + a, found + f])
    }

    fn document(&self) -> Document {
        let mut sections: Vec<ReportSection> = gear::section(self).into_iter().collect();
        sections.extend([inputs::section(self), machines::section(self)]);
        sections.extend(solids::section(self));
        sections.push(results::section(self));
        sections.extend([extremes::section(self), ends::section(self)]);
        sections.extend(influences::section(self));
        sections.extend(contacts::section(self));
        sections.extend(millings::section(self));
        sections.extend(pictures::section(self));
        let unchecked = unchecked::unchecked(self);
        let blocks = vec![
            Block::Heading("In this job".to_string()),
            Block::List(unchecked.of_job),
            Block::Heading("In any report".to_string()),
            Block::List(unchecked.always),
        ];
        sections.push(ReportSection { title: "What was not checked".to_string(), blocks });
        sections.push(conventions::section(self));
        let header = &self.header;
        Document {
            kind: "Report on generated surfaces".to_string(),
            title: self.job.name.clone(),
            opening: self.opening(),
            sections,
            closing: format!("{} \u{b7} {} \u{b7} {}", header.program, header.spec, header.spec_hash),
        }
    }

    fn opening(&self) -> Vec<Block> {
        let mut blocks = Vec::new();
        let doc: Vec<&str> = self.job.doc.iter().map(|line| line.trim()).collect();
        if !doc.is_empty() {
            blocks.push(Block::Paragraph(doc.join(" ")));
        }
        let header = &self.header;
        let mut facts = vec![("spec".to_string(), header.spec.clone())];
        let set = self.request.jobs.set_in(&[self.job]).into_iter();
        facts.extend(set.map(|(name, value)| ("set by hand".to_string(), format!("{name} = {value}"))));
        facts.extend(self.request.date.iter().map(|date| ("date".to_string(), date.clone())));
        facts.push(("made by".to_string(), header.program.clone()));
        blocks.push(Block::Facts(facts));
        blocks.push(self.verdict());
        blocks.extend(pictures::first(self));
        blocks
    }

    fn verdict(&self) -> Block {
        let [asked, found] = self.counts();
        let worst = self.solved().iter().filter_map(|solved| solved.summary.worst_residual).reduce(f64::max);
        let worst = worst
            .map_or(String::new(), |worst| format!("; worst residual {worst:.1e} mm, tolerance {TOLERANCE:.0e} mm"));
        let counts = if found == asked {
            format!("All {asked} points are solved")
        } else {
            format!("{found} of {asked} points are solved")
        };
        let text = format!("{counts}{worst}");
        let is_good = self.failures().is_empty();
        let mut more = Vec::new();
        let undercut = ends::undercut_count(self);
        if undercut > 0 {
            more.push(format!("{undercut} points are cut away by the tool that generates them (undercut)"));
        }
        more.extend(self.gears.iter().flat_map(|gear| gear.uncut.iter().map(|told| told.message.clone())));
        more.extend(travel::beyond(self.job, self.solved()).into_iter().map(|axis| axis.message));
        more.extend(required::missed(self.solved()).into_iter().map(|missed| missed.message));
        Block::Notice(if is_good { Tone::Good } else { Tone::Bad }, text, more)
    }

    fn result(&self, document: &Document, files: Vec<String>) -> ReportResult {
        let header = &self.header;
        let unchecked = unchecked::unchecked(self);
        let [asked, solved] = self.counts();
        let picture = |figure: &Figure| ReportedPicture { name: figure.name.clone(), shows: figure.caption.clone() };
        ReportResult {
            job: self.job.name.clone(),
            doc: self.job.doc.clone(),
            spec: header.spec.clone(),
            spec_hash: header.spec_hash.clone(),
            program: header.program.clone(),
            command: conventions::command(self),
            date: self.request.date.clone(),
            tolerance: TOLERANCE,
            asked,
            solved,
            undercut: ends::undercut_count(self),
            inputs: inputs::told(self),
            motions: inputs::motions_told(self),
            machines: machines::told(self),
            solids: solids::all(self),
            traces: self.traces.clone(),
            contacts: self.contacts.iter().map(|(contact, _)| contact.clone()).collect(),
            millings: self.millings.iter().map(|(milling, _)| milling.clone()).collect(),
            surfaces: results::told(self),
            lines: ends::told(self),
            faces: step::results(&self.faces),
            pictures: document.figures().map(picture).collect(),
            not_checked: NotChecked { of_this_job: unchecked.of_job, by_no_report: unchecked.always },
            conventions: conventions::sentences(self),
            files,
            not_done: self.origin.located(&[self.job], self.failures()),
        }
    }
}
