//! What stands between two braces.

use std::ops::Range;

use pest::iterators::Pair;

use super::super::ast::{JobStatement, MachineStatement, ToolStatement};
use super::super::build::{Build, SurfaceParts};
use super::super::grammar::Rule;
use super::super::scan::Scan;
use super::super::{salvage, words};

/// The statements of a block so far.
pub(super) enum Block {
    Machine(Vec<MachineStatement>),
    Tool(Vec<ToolStatement>),
    Surface(Box<SurfaceParts>),
    Job(Vec<JobStatement>),
}

impl Block {
    pub(super) fn noun(&self) -> &'static str {
        match self {
            Block::Machine(_) => "machine",
            Block::Tool(_) => "tool",
            Block::Surface(_) => "surface",
            Block::Job(_) => "job",
        }
    }

    pub(super) fn words(&self) -> &'static [&'static str] {
        match self {
            Block::Machine(_) => words::IN_MACHINE,
            Block::Tool(_) => words::IN_TOOL,
            Block::Surface(_) => words::IN_SURFACE,
            Block::Job(_) => words::IN_JOB,
        }
    }

    pub(super) fn rule(&self) -> Rule {
        match self {
            Block::Machine(_) => Rule::machine_piece,
            Block::Tool(_) => Rule::tool_piece,
            Block::Surface(_) => Rule::tool_surface_piece,
            Block::Job(_) => Rule::job_piece,
        }
    }

    pub(super) fn add(&mut self, build: &mut Build, pair: Pair<'_, Rule>) {
        match self {
            Block::Machine(statements) => statements.extend(build.machine_statement(pair)),
            Block::Tool(statements) => statements.extend(build.tool_statement(pair)),
            Block::Surface(parts) => build.surface_statement(parts, pair),
            Block::Job(statements) => statements.extend(build.job_statement(pair)),
        }
    }

    /// Adds what a broken statement would have defined.
    pub(super) fn add_broken(&mut self, scan: &Scan, word: &str, range: Range<usize>) {
        match self {
            Block::Machine(statements) => statements.extend(salvage::machine_statement(scan, word, range)),
            Block::Tool(statements) => statements.extend(salvage::tool_statement(scan, word, range)),
            Block::Surface(parts) => salvage::surface_statement(scan, parts, word, range),
            Block::Job(statements) => statements.extend(salvage::job_statement(scan, word, range)),
        }
    }
}
