//! Maker of plans of one truck and seed.

use crate::manoeuvres::drives::{BenchTruck, Plan};
use crate::manoeuvres::parts::{add_edit, add_section};
use crate::manoeuvres::signals::Edit;
use crate::manoeuvres::truth::When;
use host_sim::simulator::manoeuvre_file::Section;

/// Where manoeuvres begin, m from the start of the drive.
pub const ONSET_M: f64 = 15_000.0;

/// Makes plans of one truck and seed.
pub struct Maker(pub BenchTruck, pub u64);

impl Maker {
    /// Makes a plan.
    pub fn plan(&self, name: impl Into<String>, shape: impl FnOnce(&mut Plan)) -> Plan {
        let mut plan = Plan::new(name, self.0, self.1);
        shape(&mut plan);
        plan
    }

    /// Makes a plan with an edit of frames, which is the fault.
    pub fn edit(&self, name: impl Into<String>, when: When, edit: Edit) -> Plan {
        self.plan(name, |plan| add_edit(plan, when, edit))
    }

    /// Makes a plan with a section, which is the fault.
    pub fn section(&self, name: impl Into<String>, section: Section) -> Plan {
        self.plan(name, |plan| add_section(plan, section))
    }
}
