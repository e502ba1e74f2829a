//! The flight core as two tasks of RTIC on a Cortex-M7: the control cycle preempts the forecast.
//!
//! `SysTick` runs the cycle at a high priority: clock, tables, sequencer, events. `idle` runs the
//! forecast a bounded step at a time and is interrupted by cycles; it shares with them only the state,
//! which RTIC's lock protects. Neither task allocates; the container lies in the program.
//!
//! When the day is over and the forecast done, what happened is on the host's standard output and the
//! run ends: exit code 0, or 1 after a fault.

#![no_std]
#![no_main]

mod device;
mod flight;

use core::panic::PanicInfo;
use cortex_m_rt as _;
use cortex_m_semihosting::debug;

/// The container of a plan.
static CONTAINER: &[u8] = include_bytes!(env!("GYRFALCON_UPLINK"));

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        debug::exit(debug::EXIT_FAILURE);
    }
}

#[rtic::app(device = crate::device, peripherals = false)]
mod app {
    use super::CONTAINER;
    use crate::flight::{self, Cycle};
    use cortex_m::peripheral::syst::SystClkSource;
    use cortex_m_semihosting::{debug, hio, hprintln};
    use onboard_core::sequencer::State;
    use onboard_core::transit::Channel;
    use onboard_core::uplink::Tables;

    /// Processor cycles from control cycle to control cycle: a millisecond of the board's 25 MHz.
    const PERIOD: u32 = 25_000;

    #[shared]
    struct Shared {
        /// What the spacecraft does; none when the day is over.
        state: Option<State>,
    }

    #[local]
    struct Local {
        cycle: Cycle,
        out: hio::HostStream,
        channel: Channel<'static>,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let ready = Tables::load(CONTAINER)
            .ok()
            .and_then(|tables| Some((Cycle::new(tables)?, flight::channel(&tables)?)));
        let (Some((cycle, channel)), Ok(out)) = (ready, hio::hstdout()) else { fail() };
        let mut clock = context.core.SYST;
        clock.set_clock_source(SystClkSource::Core);
        clock.set_reload(PERIOD - 1);
        clock.clear_current();
        clock.enable_counter();
        clock.enable_interrupt();
        (Shared { state: Some(State::Idle) }, Local { cycle, out, channel })
    }

    /// The control cycle.
    #[task(binds = SysTick, priority = 2, shared = [state], local = [cycle, out])]
    fn cycle(mut context: cycle::Context) {
        let state = match context.local.cycle.run(context.local.out) {
            None => None,
            Some(Ok(state)) => Some(state),
            Some(Err(_)) => fail(),
        };
        context.shared.state.lock(|shared| *shared = state);
    }

    /// The background.
    #[idle(shared = [state], local = [channel])]
    fn idle(mut context: idle::Context) -> ! {
        let next = flight::forecast(context.local.channel);
        while context.shared.state.lock(|state| state.is_some()) {}
        hprintln!("{:?}", next);
        loop {
            debug::exit(debug::EXIT_SUCCESS);
        }
    }

    /// Ends the run as failed.
    fn fail() -> ! {
        loop {
            debug::exit(debug::EXIT_FAILURE);
        }
    }
}
