//! A live bus, listened to until the drive ends.

use super::publisher::Publisher;
use super::session::{Reaction, Session};
use super::show::Show;
use super::stop_flag::stop_flag;
use super::view::View;
use crate::error::{Error, Result};
use crate::files::kept;
use crate::files::output::Staged;
use crate::files::vehicle::VehicleFile;
use crate::recorder::{LongRun, Recorder};
use crate::source::log_time;
use crate::source::socketcan::{BusEvent, Received, Receiver, of_group, wanted};
use estimator_core::{Estimator, PersistentStateError, Tuning};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant as Monotonic};

/// An event that repeats is told no more often.
const TELL_AGAIN: Duration = Duration::from_secs(1);

/// What is listened to, and what is done with it.
#[derive(Clone, Copy, Debug)]
pub struct ListenRequest<'a> {
    /// CAN interfaces, each once.
    pub interfaces: &'a [String],
    /// File of the vehicle, for messages.
    pub vehicle_file: &'a Path,
    /// File with what the last drive left.
    pub kept: Option<&'a Path>,
    /// File that the frames received go to.
    pub log: Option<&'a Path>,
    /// J1939 address to send the estimate from.
    pub address: Option<u8>,
    /// Frames have the time of the log that is replayed.
    pub log_time: bool,
    /// The drive ends when no frame has come for so long.
    pub end_after_silence: Option<Duration>,
    /// JSON instead of lines and panel.
    pub json: bool,
}

/// A drive that is listened to.
pub struct Listening<'a> {
    request: ListenRequest<'a>,
    receiver: Receiver,
    session: Session,
    publisher: Option<Publisher>,
    show: Show,
    stop: Arc<AtomicBool>,
    told: BTreeMap<(usize, BusEvent), Monotonic>,
}

/// What a drive that is over leaves.
pub struct Ended {
    /// The last view of it.
    pub view: View,
    /// Whether that could be shown.
    pub shown: Result<()>,
    /// The run, smoothed as a whole.
    pub run: Result<LongRun>,
    /// The log of what was received, to appear when committed.
    pub log: Result<Option<Staged>>,
    /// Whether the view takes stdout.
    pub takes_stdout: bool,
}

impl<'a> Listening<'a> {
    /// Begins to listen.
    ///
    /// # Errors
    /// An impossible vehicle, or not that of the last drive; an interface or a file that cannot be
    /// opened.
    pub fn begin(request: ListenRequest<'a>, vehicle: &VehicleFile) -> Result<Self> {
        let (parameters, tuning) = (vehicle.model.clone(), Tuning::default());
        let kept = match request.kept {
            Some(file) => kept::read(file, &parameters)?,
            None => None,
        };
        let estimator = match &kept {
            Some(kept) => Estimator::<f32>::restore(parameters, tuning, kept),
            None => Estimator::new(parameters, tuning).map_err(PersistentStateError::from),
        };
        let estimator =
            estimator.map_err(|e| Error::content(request.vehicle_file, e.to_string()))?;
        let session = Session::begin(
            Recorder::from(estimator),
            request.interfaces,
            request.log_time,
            request.log,
        )?;
        let mut filters = wanted();
        if request.log_time {
            filters.push(of_group(log_time::PGN));
        }
        let stop = stop_flag()?;
        let receiver = Receiver::start(request.interfaces, &filters, Arc::clone(&stop))?;
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
            told: BTreeMap::new(),
        })
    }

    /// Takes traffic until it is told to end, or the log or its traffic is over.
    ///
    /// # Errors
    /// What the terminal or the log file says.
    pub fn run(&mut self) -> Result<()> {
        loop {
            let mut patience = self.show.due_in();
            if let Some(due) = self.publisher.as_ref().and_then(Publisher::due_in) {
                patience = patience.min(due);
            }
            let Some(stretch) = self.receiver.next(patience) else {
                return Ok(());
            };
            let mut is_over = false;
            for received in &stretch {
                is_over |= self.take(received)?;
            }
            let cells = self.session.fetch_cells();
            if let Some(publisher) = &mut self.publisher {
                publisher.publish(self.session.live().as_ref(), &cells);
            }
            if is_over {
                return Ok(());
            }
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
                // The receiver hands out what it still has, and ends.
                self.stop.store(true, Ordering::Relaxed);
            }
        }
    }

    /// Ends the drive: the last view, and smoothing over the whole of it.
    #[must_use]
    pub fn finish(self) -> Ended {
        let Self {
            mut session,
            publisher,
            mut show,
            ..
        } = self;
        let view = session.view(publisher.and_then(|publisher| publisher.unsent()));
        let shown = show.show_last(&view);
        let (run, log) = session.finish();
        Ended {
            view,
            shown,
            run,
            log,
            takes_stdout: show.takes_stdout(),
        }
    }

    /// Takes what was received; true if the log is over.
    fn take(&mut self, received: &Received) -> Result<bool> {
        let reaction = self.session.take(received)?;
        match reaction {
            Reaction::None => {}
            Reaction::Tell(event) => self.tell(received.interface, event),
            Reaction::Answer(answer) | Reaction::End(answer) => {
                if let Some(publisher) = &mut self.publisher {
                    publisher.answer(answer);
                }
            }
        }
        Ok(matches!(reaction, Reaction::End(_)))
    }

    fn tell(&mut self, interface: usize, event: BusEvent) {
        let now = Monotonic::now();
        let is_new = |told: &Monotonic| now.duration_since(*told) >= TELL_AGAIN;
        if event.is_change() && self.told.get(&(interface, event)).is_none_or(is_new) {
            self.told.insert((interface, event), now);
            let name = &self.request.interfaces[interface];
            self.show.say(&format!("{name}: {}", event.words()));
        }
    }
}
