//! Tests entry, return and priority of exceptions.

use super::*;

/// `STR R0, [R1]`.
const STORE: u16 = 0x6008;

fn pend(bench: &mut Bench, line: usize) {
    bench.cpu.signals.set_line(line, true);
    bench.cpu.signals.set_line(line, false);
}

#[test]
fn an_interrupt_saves_and_restores_the_registers_that_the_manual_lists() {
    let mut bench = Bench::new(&nops(8));
    bench.enable(0, 0);
    bench.handler(16, &[SELF_LOOP]);
    for n in 0..13 {
        bench.cpu.set_register(n, 0x100 + n as u32);
    }
    bench.cpu.set_register(14, 0xABCD);
    bench.cpu.set_program_status(0xF800_0000);
    bench.go(2);
    let interrupted_at = bench.r(15);
    pend(&mut bench, 0);
    bench.go(20);
    assert_eq!(bench.cpu.exception(), 16);
    assert_eq!(bench.r(14), 0xFFFF_FFF9);
    let sp = bench.r(13);
    assert_eq!(sp, STACK - 32);
    let frame: Vec<u32> = (0..8).map(|i| bench.peek(sp + 4 * i)).collect();
    let expected = [
        0x100,
        0x101,
        0x102,
        0x103,
        0x10C,
        0xABCD,
        interrupted_at,
        0xF900_0000,
    ];
    assert_eq!(frame, expected);

    bench.handler(16, &[0x2000, RETURN]);
    bench.cpu.set_register(15, 0x0800_1000 + 16 * 64);
    bench.go(15);
    assert_eq!(bench.cpu.exception(), 0);
    assert_eq!(
        (bench.r(0), bench.r(13), bench.r(14)),
        (0x100, STACK, 0xABCD)
    );
    assert_eq!(bench.cpu.program_status(), 0xF900_0000);
}

#[test]
fn a_stack_at_an_odd_word_is_aligned_for_the_frame_and_restored() {
    let mut bench = Bench::new(&nops(8));
    bench.enable(0, 0);
    bench.handler(16, &[NOP, NOP, RETURN]);
    bench.cpu.set_register(13, STACK - 4);
    pend(&mut bench, 0);
    bench.go(13);
    assert_eq!(bench.r(13), STACK - 8 - 32);
    assert_eq!(bench.peek(bench.r(13) + 28) >> 9 & 1, 1);
    bench.go(40);
    assert_eq!(bench.r(13), STACK - 4);
}

#[test]
fn the_most_urgent_exception_and_then_the_lowest_number_comes_first() {
    let mut bench = Bench::new(&[]);
    for (line, priority) in [(0, 0x40), (1, 0x20), (2, 0x20)] {
        bench.enable(line, priority);
        pend(&mut bench, line.into());
    }
    // In hexadecimal: first 17, then 18, then 16, each as a digit above 16.
    bench.go(100);
    assert_eq!(bench.handled(), (17 * 16 + 18) * 16 + 16);
}

#[test]
fn a_tail_chained_exception_reuses_the_frame() {
    let mut bench = Bench::new(&[]);
    bench.enable(0, 0x40);
    bench.enable(1, 0x40);
    pend(&mut bench, 0);
    pend(&mut bench, 1);
    bench.cpu.record_activations(true);
    bench.go(100);
    let done = bench.cpu.take_activations();
    assert_eq!([done[0].exception, done[1].exception], [16, 17]);
    // First the entry, two instructions, BX and its refill. Then tail-chaining instead of an entry, and the return.
    assert_eq!(done[0].cycles, 12 + 2 + 3);
    assert_eq!(done[1].cycles, 6 + 2 + 3 + 12);
    assert_eq!(done[1].entered, done[0].left + 6);
    assert_eq!(done[0].instructions, 3);
    assert_eq!(bench.r(13), STACK);
}

#[test]
fn cycles_of_a_preempting_exception_do_not_count_for_the_preempted_one() {
    let mut bench = Bench::new(&[]);
    bench.enable(0, 0x40);
    bench.enable(1, 0x20);
    bench.handler(16, &[NOP, NOP, NOP, NOP, NOP, NOP, NOP, NOP, RETURN]);
    bench.cpu.record_activations(true);
    pend(&mut bench, 0);
    bench.go(15);
    assert_eq!(bench.cpu.exception(), 16);
    pend(&mut bench, 1);
    bench.go(100);
    let done = bench.cpu.take_activations();
    assert_eq!([done[0].exception, done[1].exception], [17, 16]);
    assert_eq!(done[1].instructions, 9);
    assert_eq!(done[1].cycles, 12 + 8 + 3 + 12);
    assert_eq!(done[0].cycles, 12 + 2 + 3 + 12);
}

#[test]
fn an_exception_of_equal_priority_does_not_preempt() {
    let mut bench = Bench::new(&[]);
    // PRIGROUP 6: only the highest priority bit decides on preemption.
    bench.poke(0xE000_ED0C, 0x05FA_0600);
    bench.enable(0, 0x60);
    bench.enable(1, 0x20);
    bench.handler(16, &[NOP, NOP, NOP, NOP, 0x013F, 0x3701, RETURN]);
    pend(&mut bench, 0);
    bench.go(14);
    pend(&mut bench, 1);
    bench.go(100);
    assert_eq!(bench.handled(), 16 + 17);
}

#[test]
fn a_late_urgent_exception_takes_over_the_entry() {
    let mut bench = Bench::new(&[]);
    bench.enable(0, 0x40);
    bench.enable(1, 0x20);
    bench.cpu.record_activations(true);
    pend(&mut bench, 0);
    // The entry takes 12 cycles. The other exception arrives within them.
    bench.go(1);
    assert_eq!(bench.cpu.exception(), 16);
    pend(&mut bench, 1);
    bench.go(100);
    let done = bench.cpu.take_activations();
    assert_eq!([done[0].exception, done[1].exception], [17, 16]);
    assert_eq!(done[0].cycles, 12 + 6 + 2 + 3);
    assert_eq!(done[1].cycles, 6 + 2 + 3 + 12, "chained on the one frame");
    assert_eq!(bench.r(13), STACK);
}

#[test]
fn basepri_masks_exceptions_that_are_not_more_urgent() {
    let mut bench = Bench::new(&[0xF380, 0x8811, NOP]);
    bench.cpu.set_register(0, 0x40);
    bench.enable(0, 0x40);
    bench.enable(1, 0x30);
    bench.go(3);
    pend(&mut bench, 0);
    pend(&mut bench, 1);
    bench.go(100);
    assert_eq!(bench.handled(), 17);
    // MSR BASEPRI, R0 with R0 = 0 removes the mask.
    bench.cpu.set_register(0, 0);
    bench.cpu.set_register(15, MAIN);
    bench.go(100);
    assert_eq!(bench.handled(), 17 * 16 + 16);
}

#[test]
fn primask_masks_interrupts_but_they_end_sleep() {
    let mut bench = Bench::new(&[0xB672, WAIT_FOR_INTERRUPT, 0x2401, NOP, 0xB662, NOP]);
    bench.enable(0, 0);
    bench.go(50);
    assert!(bench.cpu.asleep());
    assert_eq!(bench.r(4), 0);
    pend(&mut bench, 0);
    bench.go(2);
    assert_eq!((bench.r(4), bench.handled()), (1, 0));
    bench.go(50);
    assert_eq!(bench.handled(), 16);
}

#[test]
fn a_line_that_stays_high_pends_again() {
    let mut bench = Bench::new(&[]);
    bench.enable(1, 0);
    bench.cpu.set_register(1, DEVICE);
    // The handler lowers its line at the third call. R5 counts the calls.
    bench.handler(17, &[0x3501, 0x2D03, 0xBF08, STORE, RETURN]);
    bench.cpu.signals.set_line(1, true);
    bench.go(300);
    assert_eq!(bench.r(5), 3);
    assert_eq!(bench.cpu.totals(17).count, 3);
}

#[test]
fn an_interrupt_stays_pending_if_its_line_falls_before_the_handler_starts() {
    let mut bench = Bench::new(&[]);
    pend(&mut bench, 0);
    bench.go(5);
    bench.enable(0, 0);
    bench.go(50);
    assert_eq!(bench.handled(), 16);
}

#[test]
fn clearing_a_pending_bit_has_no_effect_while_the_line_is_high() {
    let mut bench = Bench::new(&[]);
    bench.cpu.signals.set_line(3, true);
    bench.go(5);
    bench.poke(0xE000_E280, 1 << 3);
    assert_eq!(bench.peek(0xE000_E200), 1 << 3);
    bench.cpu.signals.set_line(3, false);
    bench.poke(0xE000_E280, 1 << 3);
    assert_eq!(bench.peek(0xE000_E200), 0);
}

#[test]
fn an_interrupt_within_an_it_block_returns_into_it() {
    // CMP R0, R0; ITTE EQ; MOVEQ R1, #1; STREQ R2, [R3]; MOVNE R4, #3; MOVS R5, #1
    let mut bench = Bench::new(&[0x4280, 0xBF06, 0x2101, 0x601A, 0x2403, 0x2501]);
    bench.enable(1, 0);
    bench.cpu.set_register(2, 1);
    bench.cpu.set_register(3, DEVICE);
    // The handler lowers the line and changes the flags.
    bench.handler(17, &[0x2200, 0x601A, 0x2601, RETURN]);
    bench.go(200);
    assert_eq!(bench.cpu.totals(17).count, 1);
    assert_eq!(
        (bench.r(1), bench.r(4), bench.r(5), bench.r(6)),
        (1, 0, 1, 1)
    );
}

#[test]
fn pendsv_of_low_priority_waits_for_interrupts() {
    let mut bench = Bench::new(&[]);
    bench.poke(0xE000_ED20, 0x00F0_0000);
    bench.enable(0, 0x20);
    bench.poke(0xE000_ED04, 1 << 28);
    pend(&mut bench, 0);
    bench.go(100);
    assert_eq!(bench.handled(), 16 * 16 + 14);
}

#[test]
fn nmi_is_not_masked() {
    let mut bench = Bench::new(&[0xB671, NOP, NOP]);
    bench.go(4);
    bench.cpu.signals.set_nmi(true);
    bench.cpu.signals.set_nmi(false);
    bench.go(60);
    assert_eq!(bench.handled(), 2);
}

#[test]
fn a_supervisor_call_returns_to_the_next_instruction() {
    let mut bench = Bench::new(&[0xDF05, 0x2401]);
    bench.go(60);
    assert_eq!((bench.handled(), bench.r(4)), (11, 1));
}

#[test]
fn sleep_on_exit_executes_no_instruction_of_the_thread() {
    let mut bench = Bench::new(&[WAIT_FOR_INTERRUPT, 0x2401]);
    bench.enable(0, 0);
    bench.poke(0xE000_ED10, 2);
    bench.go(20);
    pend(&mut bench, 0);
    bench.go(100);
    assert!(bench.cpu.asleep());
    assert_eq!((bench.handled(), bench.r(4)), (16, 0));
}

mod float_frames {
    use super::*;

    /// `VMOV.F32 S0, #1.0`.
    const FLOAT: [u16; 2] = [0xEEB7, 0x0A00];
    const FPCCR: u32 = 0xE000_EF34;
    const UNTOUCHED: u32 = 0x5555_5555;

    fn bench(handler: &[u16]) -> Bench {
        let mut bench = Bench::new(&[FLOAT[0], FLOAT[1], NOP, NOP]);
        bench.enable(0, 0);
        bench.handler(16, handler);
        for at in (STACK - 0x80..STACK).step_by(4) {
            bench.poke(at, UNTOUCHED);
        }
        bench.go(1);
        bench.cpu.set_float_register(5, 0x1234);
        bench.cpu.set_float_status(0x8000_0010);
        pend(&mut bench, 0);
        bench
    }

    #[test]
    fn lazy_stacking_writes_no_fpu_registers_if_the_handler_uses_none() {
        let mut bench = bench(&[NOP, NOP, NOP, RETURN]);
        bench.go(13);
        assert_eq!(bench.r(14), 0xFFFF_FFE9);
        assert_eq!(bench.r(13), STACK - 0x68);
        assert_eq!(bench.peek(FPCCR) & 1, 1);
        let s5 = bench.r(13) + 0x20 + 5 * 4;
        assert_eq!(bench.peek(s5), UNTOUCHED);
        bench.go(60);
        assert_eq!(bench.peek(FPCCR) & 1, 0);
        assert_eq!((bench.r(13), bench.cpu.float_register(5)), (STACK, 0x1234));
    }

    #[test]
    fn the_first_fpu_instruction_of_the_handler_completes_lazy_stacking() {
        let mut bench = bench(&[NOP, FLOAT[0], FLOAT[1], NOP, RETURN]);
        bench.cpu.set_float_register(0, 0x77);
        bench.go(31);
        let frame = bench.r(13);
        assert_eq!(bench.peek(frame + 0x20), 0x77);
        assert_eq!(bench.peek(frame + 0x20 + 5 * 4), 0x1234);
        assert_eq!(bench.peek(frame + 0x60), 0x8000_0010);
        assert_eq!(
            bench.cpu.float_status(),
            0,
            "the handler begins with the defaults"
        );
        bench.go(100);
        assert_eq!(bench.cpu.float_register(0), 0x77);
        assert_eq!(bench.cpu.float_status(), 0x8000_0010);
        assert_eq!(bench.r(13), STACK);
    }

    #[test]
    fn without_lazy_stacking_the_fpu_registers_are_written_at_entry() {
        let mut bench = bench(&[NOP, NOP, NOP, RETURN]);
        bench.poke(FPCCR, 1 << 31);
        bench.go(30);
        let frame = bench.r(13);
        assert_eq!(frame, STACK - 0x68);
        assert_eq!(bench.peek(frame + 0x20 + 5 * 4), 0x1234);
        bench.go(100);
        assert_eq!((bench.r(13), bench.cpu.float_register(5)), (STACK, 0x1234));
    }

    #[test]
    fn a_nested_handler_without_an_fpu_context_uses_the_basic_frame() {
        let mut bench = bench(&[NOP, NOP, NOP, RETURN]);
        bench.enable(0, 0x40);
        bench.enable(1, 0x20);
        bench.go(14);
        pend(&mut bench, 1);
        bench.go(13);
        assert_eq!(bench.cpu.exception(), 17);
        assert_eq!(bench.r(14), 0xFFFF_FFF1);
        assert_eq!(bench.r(13), STACK - 0x68 - 0x20);
        bench.go(200);
        assert_eq!(bench.r(13), STACK);
    }
}
