//! Who ends the program while it works on a study.

/// From now on Ctrl-C, or a queue that ends the program in order, is noted in the study: the case that is worked on then did not end it.
#[cfg(unix)]
pub(crate) fn watch() {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;

    // without it each end counts as one by the case
    let Ok(mut signals) = Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            flank::note_interruption();
            _ = signal_hook::low_level::emulate_default_handler(signal);
        }
    });
}

/// Elsewhere the program does not hear of it.
#[cfg(not(unix))]
pub(crate) fn watch() {}
