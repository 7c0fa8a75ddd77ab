//! An object of a file that is one way in both directions, while it is read.

use super::network_draft::{DraftWay, NetworkDraft, Position};
use crate::map::geometry::way_name::WayDirection;

/// The object so far.
#[derive(Default)]
pub(super) struct DraftTrack {
    pub(super) name: String,
    parts: Vec<Vec<Position>>,
    /// Number of points that are left out, and why the first one is.
    left_out: usize,
    problem: Option<String>,
}

impl DraftTrack {
    /// Begins another line.
    pub(super) fn begin_part(&mut self) {
        self.parts.push(Vec::new());
    }

    /// Adds a position to the newest line. What is none is left out.
    pub(super) fn add(&mut self, position: Result<Position, String>) {
        match position {
            Ok(position) => match self.parts.last_mut() {
                Some(part) => part.push(position),
                None => self.parts.push(vec![position]),
            },
            Err(problem) => {
                self.left_out += 1;
                self.problem.get_or_insert(problem);
            }
        }
    }

    /// Adds the way to the network. `kind` and `number` name it, as the name does if it has one.
    /// The draft notes how many points it leaves out, and why the first one.
    ///
    /// # Errors
    /// Returns an error if the network becomes too large.
    pub(super) fn end(
        self,
        kind: &str,
        number: usize,
        draft: &mut NetworkDraft,
    ) -> Result<(), String> {
        let unnamed = format!("{kind} {number}");
        let name = match self.name {
            name if name.is_empty() => unnamed.clone(),
            name => name,
        };
        let place = format!("{unnamed}, {name}");
        match (self.left_out, self.problem) {
            (1, Some(problem)) => draft.leave_out(format!("{place}: a point: {problem}")),
            (count, Some(problem)) => {
                draft.leave_out(format!("{place}: {count} points, the first: {problem}"));
            }
            (_, None) => {}
        }
        let way = DraftWay {
            name,
            parts: self.parts,
            directions: vec![WayDirection::Forward, WayDirection::Backward],
            structure: None,
        };
        draft.add(&place, way)
    }
}
