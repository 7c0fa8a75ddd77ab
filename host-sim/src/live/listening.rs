//! A drive on a live bus, from the first frame to the last.

use super::publisher::Publisher;
use super::saved_memory::SavedMemory;
use super::session::{Reaction, Session};
use super::show::Show;
use super::stop_flag::stop_flag;
use super::view::LiveView;
use crate::error::{Error, Result};
use crate::files::flash_image::RoadMemoryFile;
use crate::files::kept;
use crate::files::output::Staged;
use crate::files::vehicle::VehicleFile;
use crate::recorder::{LongRun, Recorder};
use crate::source::log_time;
use crate::source::own_signals::OwnSignals;
use crate::source::socketcan::{
    BusEvent, FrameReceiver, Received, ReceivedItem, of_frames, of_group, wanted,
};
use estimator_core::Tuning;
use estimator_core::roadmap::PackedMap;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant as Monotonic};

/// Minimum time between two reports of the same event.
const REPORT_INTERVAL: Duration = Duration::from_secs(1);

/// Options of a live drive.
#[derive(Debug)]
pub struct ListenRequest<'a> {
    /// CAN interfaces, each once.
    pub interfaces: &'a [String],
    /// Vehicle file, for error messages.
    pub vehicle_file: &'a Path,
    /// File of the persistent state of the last drive.
    pub state_file: Option<&'a Path>,
    /// Values for the estimator's parameters.
    pub tuning: Tuning,
    /// File for the received frames.
    pub log: Option<&'a Path>,
    /// J1939 source address of the published estimate; `None` if publishing is off.
    pub address: Option<u8>,
    /// Use the time stamps of the replayed log.
    pub log_time: bool,
    /// End the drive after this time without a frame.
    pub end_after_silence: Option<Duration>,
    /// Signals of the user's own messages.
    pub own: Option<Arc<OwnSignals>>,
    /// Map for the live grade and the road ahead.
    pub map: Option<PackedMap<'static>>,
    /// Road memory, and its file.
    pub memory: Option<(&'a Path, RoadMemoryFile)>,
    /// Print JSON instead of lines and panel.
    pub json: bool,
}

/// A live drive in progress.
pub struct Listening<'a> {
    request: ListenRequest<'a>,
    receiver: FrameReceiver,
    session: Session,
    publisher: Option<Publisher>,
    show: Show,
    stop: Arc<AtomicBool>,
    reported: BTreeMap<(usize, BusEvent), Monotonic>,
    /// The file of the road memory; `None` without one.
    saved: Option<SavedMemory<'a>>,
}

/// The result of a finished live drive.
pub struct EndedDrive {
    /// The last view.
    pub view: LiveView,
    /// The result of showing the last view.
    pub shown: Result<()>,
    /// The run, smoothed as a whole.
    pub run: Result<LongRun>,
    /// The log of the received frames; it appears when it is committed.
    pub log: Result<Option<Staged>>,
    /// True if the view is printed on stdout.
    pub takes_stdout: bool,
}

impl<'a> Listening<'a> {
    /// Opens the interfaces and files, and begins the drive.
    ///
    /// # Errors
    /// Returns an error for invalid vehicle parameters, for a persistent state of another vehicle,
    /// and for an interface or a file that cannot be opened.
    pub fn begin(mut request: ListenRequest<'a>, vehicle: &VehicleFile) -> Result<Self> {
        let last = match request.state_file {
            Some(file) => kept::read(file, &vehicle.model)?,
            None => None,
        };
        let recorder = Recorder::resume(&vehicle.model, &request.tuning, last.as_ref())
            .map_err(|e| Error::content(request.vehicle_file, e.to_string()))?;
        let (memory_file, memory) = request.memory.take().unzip();
        let session = Session::begin(recorder, request.interfaces, request.log_time, request.log)?
            .with_own_signals(request.own.clone())
            .with_map(request.map)
            .with_memory(memory);
        let mut filters = wanted();
        let own = request.own.iter().flat_map(|own| own.frames());
        filters.extend(own.map(of_frames));
        if request.log_time {
            filters.push(of_group(log_time::PGN));
        }
        let stop = stop_flag()?;
        let receiver = FrameReceiver::start(request.interfaces, &filters, Arc::clone(&stop))?;
        let address = request.address;
        let publisher = if address.is_some() || request.log_time {
            Some(Publisher::open(&request.interfaces[0], address)?)
        } else {
            None
        };
        let show = Show::new(request.json);
        show.say(&format!(
            "listening on {}; Ctrl-C ends the drive",
            request.interfaces.join(", ")
        ));
        show.begin()?;
        Ok(Self {
            request,
            receiver,
            session,
            publisher,
            show,
            stop,
            reported: BTreeMap::new(),
            saved: memory_file.map(SavedMemory::new),
        })
    }

    /// Processes frames until the stop flag is set, the replayed log ends, or the silence limit is
    /// reached.
    ///
    /// # Errors
    /// Returns an error of the terminal or the log file.
    pub fn run(&mut self) -> Result<()> {
        loop {
            let mut patience = self.show.due_in();
            if let Some(due) = self.publisher.as_ref().and_then(Publisher::due_in) {
                patience = patience.min(due);
            }
            let Some(batch) = self.receiver.next(patience) else {
                return Ok(());
            };
            let mut is_over = false;
            for received in &batch {
                is_over |= self.take(received)?;
            }
            let cells = self.session.fetch_cells();
            if let Some(publisher) = &mut self.publisher {
                let cells_suspect = self.session.cells_suspect();
                let (live, map) = (self.session.live(), self.session.map());
                publisher.publish(live.as_ref(), &cells, cells_suspect, map);
            }
            if is_over {
                return Ok(());
            }
            self.save_memory();
            if self.show.due_in().is_zero() {
                let unsent = self.publisher.as_ref().and_then(Publisher::unsent);
                let view = self.session.view(unsent);
                self.show.show(&view)?;
            }
            let silence = self.session.silence();
            if self
                .request
                .end_after_silence
                .is_some_and(|longest| silence >= longest)
            {
                // The receiver returns the frames that it still holds, then ends.
                self.stop.store(true, Ordering::Relaxed);
            }
        }
    }

    /// Writes the road memory if that is due. A failure does not end the drive.
    fn save_memory(&mut self) {
        if let (Some(saved), Some(memory)) = (&mut self.saved, self.session.memory())
            && let Err(e) = saved.save_if_due(memory)
        {
            self.show.say(&e.to_string());
        }
    }

    /// Ends the drive: shows the last view and smooths the whole run.
    #[must_use]
    pub fn finish(self) -> EndedDrive {
        let Self {
            mut session,
            publisher,
            mut show,
            ..
        } = self;
        let view = session.view(publisher.and_then(|publisher| publisher.unsent()));
        let shown = show.show_last(&view);
        let (run, log) = session.finish();
        EndedDrive {
            view,
            shown,
            run,
            log,
            takes_stdout: show.takes_stdout(),
        }
    }

    /// Processes a received item. Returns true if the replayed log is over.
    fn take(&mut self, received: &Received) -> Result<bool> {
        if let (ReceivedItem::Frame(frame), Some(publisher)) = (&received.item, &self.publisher)
            && publisher.has_sent(frame)
        {
            return Ok(false);
        }
        let reaction = self.session.take(received)?;
        match reaction {
            Reaction::None => {}
            Reaction::Report(event) => self.report(received.interface, event),
            Reaction::Answer(answer) | Reaction::End(answer) => {
                if let Some(publisher) = &mut self.publisher {
                    publisher.answer(answer);
                }
            }
        }
        Ok(matches!(reaction, Reaction::End(_)))
    }

    fn report(&mut self, interface: usize, event: BusEvent) {
        let now = Monotonic::now();
        let is_new = |last: &Monotonic| now.duration_since(*last) >= REPORT_INTERVAL;
        if event.is_change() && self.reported.get(&(interface, event)).is_none_or(is_new) {
            self.reported.insert((interface, event), now);
            let name = &self.request.interfaces[interface];
            self.show.say(&format!("{name}: {}", event.words()));
        }
    }
}
