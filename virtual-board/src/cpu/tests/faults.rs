//! Tests faults: invalid addresses, invalid jumps and a broken stack.

use super::*;

const CFSR: u32 = 0xE000_ED28;
const HFSR: u32 = 0xE000_ED2C;
const BFAR: u32 = 0xE000_ED38;
const SHCSR: u32 = 0xE000_ED24;
const CCR: u32 = 0xE000_ED14;
const FORCED: u32 = 1 << 30;

/// `LDR R0, [R1]`.
const LOAD: u16 = 0x6808;
/// `STR R0, [R1]`.
const STORE: u16 = 0x6008;

/// Runs `main` with R1 set and endless loops as handlers. Returns the exception in which it ends, with CFSR and HFSR.
fn fault(main: &[u16], r1: u32) -> (Bench, u16, u32, u32) {
    fault_with(main, r1, |_| {})
}

fn fault_with(main: &[u16], r1: u32, prepare: impl Fn(&mut Bench)) -> (Bench, u16, u32, u32) {
    let mut bench = Bench::new(main);
    for number in 3..7 {
        bench.handler(number, &[SELF_LOOP]);
    }
    bench.cpu.set_register(1, r1);
    prepare(&mut bench);
    bench.go(60);
    let exception = bench.cpu.exception();
    let (cfsr, hfsr) = (bench.peek(CFSR), bench.peek(HFSR));
    (bench, exception, cfsr, hfsr)
}

#[test]
fn a_load_from_an_unmapped_address_is_a_precise_bus_fault_and_escalates() {
    let (mut bench, exception, cfsr, hfsr) = fault(&[NOP, LOAD], NOWHERE);
    assert_eq!((exception, cfsr, hfsr), (3, 0x8200, FORCED));
    assert_eq!(bench.peek(BFAR), NOWHERE);
    let return_address = bench.peek(bench.r(13) + 24);
    assert_eq!(return_address, MAIN + 2, "of the load itself");
}

#[test]
fn a_buffered_store_to_an_unmapped_address_is_an_imprecise_bus_fault() {
    let (mut bench, exception, cfsr, hfsr) = fault(&[NOP, STORE, NOP], NOWHERE);
    assert_eq!((exception, cfsr, hfsr), (3, 0x0400, FORCED));
    assert_eq!(bench.peek(bench.r(13) + 24), MAIN + 4);
}

#[test]
fn without_the_write_buffer_a_store_to_an_unmapped_address_is_a_precise_bus_fault() {
    let prepare = |bench: &mut Bench| bench.poke(0xE000_E008, 2);
    let (_, exception, cfsr, _) = fault_with(&[STORE], NOWHERE, prepare);
    assert_eq!((exception, cfsr), (3, 0x8200));
}

#[test]
fn an_enabled_fault_handler_handles_its_fault() {
    let prepare = |bench: &mut Bench| bench.poke(SHCSR, 7 << 16);
    let (_, exception, cfsr, hfsr) = fault_with(&[LOAD], NOWHERE, prepare);
    assert_eq!((exception, cfsr, hfsr), (5, 0x8200, 0));
    let (_, exception, cfsr, hfsr) = fault_with(&[0xDE00], 0, prepare);
    assert_eq!((exception, cfsr, hfsr), (6, 1 << 16, 0));
}

#[test]
fn a_masked_fault_handler_escalates_to_hard_fault() {
    // CPSID I; LDR R0, [R1]
    let prepare = |bench: &mut Bench| bench.poke(SHCSR, 7 << 16);
    let (_, exception, cfsr, hfsr) = fault_with(&[0xB672, LOAD], NOWHERE, prepare);
    assert_eq!((exception, cfsr, hfsr), (3, 0x8200, FORCED));
}

#[test]
fn a_jump_to_an_even_address_is_an_invalid_state() {
    // BX R1
    let (_, exception, cfsr, _) = fault(&[0x4708], MAIN);
    assert_eq!((exception, cfsr), (3, 1 << 17));
}

#[test]
fn jumps_to_addresses_without_code_are_faults() {
    for (target, status) in [
        (0x4000_0001, 1),
        (0xE000_E001, 1),
        (0x0900_0001, 1 << 8),
        (Memories::CCM | 1, 1 << 8),
    ] {
        let (_, exception, cfsr, _) = fault(&[0x4708], target);
        assert_eq!((exception, cfsr), (3, status), "{target:#x}");
    }
}

#[test]
fn in_thread_mode_a_jump_to_an_exception_return_value_is_a_fault() {
    let (_, exception, cfsr, _) = fault(&[0x4708], 0xFFFF_FFF9);
    assert_eq!((exception, cfsr), (3, 1));
}

#[test]
fn an_unaligned_word_is_allowed_in_memory_and_a_fault_elsewhere() {
    let (bench, exception, ..) = fault(&[LOAD], Memories::SRAM + 1);
    assert_eq!((exception, bench.r(0)), (0, 0));
    let (_, exception, cfsr, _) = fault(&[LOAD], DEVICE + 1);
    assert_eq!((exception, cfsr), (3, 1 << 24));
    // LDM R1, {R2, R3}
    let (_, exception, cfsr, _) = fault(&[0xE891, 0x000C], Memories::SRAM + 2);
    assert_eq!((exception, cfsr), (3, 1 << 24));
    let trap = |bench: &mut Bench| bench.poke(CCR, 0x208);
    let (_, exception, cfsr, _) = fault_with(&[LOAD], Memories::SRAM + 1, trap);
    assert_eq!((exception, cfsr), (3, 1 << 24));
}

#[test]
fn a_division_by_zero_gives_zero_or_a_fault_if_the_trap_is_enabled() {
    // UDIV R0, R1, R2
    let (bench, exception, ..) = fault(&[0xFBB1, 0xF0F2], 7);
    assert_eq!((exception, bench.r(0)), (0, 0));
    let trap = |bench: &mut Bench| bench.poke(CCR, 0x210);
    let (_, exception, cfsr, _) = fault_with(&[0xFBB1, 0xF0F2], 7, trap);
    assert_eq!((exception, cfsr), (3, 1 << 25));
}

#[test]
fn an_fpu_instruction_with_the_fpu_disabled_is_a_fault() {
    let off = |bench: &mut Bench| bench.poke(0xE000_ED88, 0);
    let (_, exception, cfsr, _) = fault_with(&[0xEEB7, 0x0A00], 0, off);
    assert_eq!((exception, cfsr), (3, 1 << 19));
}

#[test]
fn a_breakpoint_without_a_debugger_is_a_hard_fault() {
    let (_, exception, cfsr, hfsr) = fault(&[0xBE00], 0);
    assert_eq!((exception, cfsr, hfsr), (3, 0, 1 << 31));
}

#[test]
fn a_stack_overflow_out_of_ram_still_reaches_hard_fault() {
    let below = |bench: &mut Bench| bench.cpu.set_register(13, Memories::SRAM + 8);
    let (_, exception, cfsr, hfsr) = fault_with(&[LOAD], NOWHERE, below);
    assert_eq!((exception, cfsr, hfsr), (3, 0x9200, FORCED));
}

#[test]
fn an_interrupt_whose_frame_does_not_fit_in_ram_is_a_stacking_fault() {
    let mut bench = Bench::new(&[]);
    bench.handler(3, &[SELF_LOOP]);
    bench.enable(0, 0x20);
    bench.cpu.set_register(13, Memories::SRAM + 8);
    bench.cpu.signals.set_line(0, true);
    bench.go(60);
    assert_eq!(bench.cpu.exception(), 3);
    assert_eq!((bench.peek(CFSR), bench.peek(HFSR)), (1 << 12, FORCED));
    assert_eq!(bench.peek(0xE000_E200), 1, "the interrupt still waits");
}

#[test]
fn a_fault_in_hard_fault_locks_up() {
    let mut bench = Bench::new(&[0xDE00]);
    bench.handler(3, &[NOP, LOAD]);
    bench.cpu.set_register(1, NOWHERE);
    let pc = 0x0800_1000 + 3 * 64 + 2;
    assert_eq!(bench.run(100), Stop::Lockup { pc });
    assert_eq!(bench.run(100), Stop::Lockup { pc }, "until a reset");
    bench.cpu.reset(&mut bench.board);
    bench.code(MAIN, &[SELF_LOOP]);
    bench.go(100);
}

#[test]
fn an_unreadable_vector_is_a_hard_fault() {
    let mut bench = Bench::new(&[]);
    bench.handler(3, &[SELF_LOOP]);
    bench.enable(0, 0x20);
    // Only the HardFault entry of the moved vector table is mapped.
    bench.poke(0xE000_ED08, Memories::SRAM + 0x1_0000 - 0x40);
    let handler = bench.peek(Memories::FLASH + 12);
    bench.poke(Memories::SRAM + 0x1_0000 - 0x80 + 12, handler);
    assert_eq!(bench.peek(0xE000_ED08) & 0x7F, 0, "a table is aligned");
    bench.poke(0xE000_ED08, Memories::SRAM + 0x1_0000 - 0x80);
    bench.vector(16, 0);
    bench.cpu.signals.set_line(0, true);
    bench.go(60);
    // The aligned table holds vector 16. It reads as zero, which is not a Thumb address.
    assert_eq!(bench.cpu.exception(), 3);
    assert_eq!(bench.peek(CFSR), 1 << 17);
}

#[test]
fn a_return_to_thread_from_a_nested_handler_is_refused() {
    let mut bench = Bench::new(&[]);
    bench.handler(3, &[SELF_LOOP]);
    bench.enable(0, 0x40);
    bench.enable(1, 0x20);
    bench.handler(16, &nops(20));
    // MVN R0, #6: 0xFFFF_FFF9; BX R0
    bench.handler(17, &[0xF06F, 0x0006, 0x4700]);
    bench.cpu.signals.set_line(0, true);
    bench.go(15);
    bench.cpu.signals.set_line(1, true);
    bench.go(60);
    assert_eq!(bench.cpu.exception(), 3);
    assert_eq!(bench.peek(CFSR), 1 << 18);
}

#[test]
fn an_unmodelled_access_stops_the_run_and_names_the_register() {
    let mut bench = Bench::new(&[LOAD]);
    bench.cpu.set_register(1, UNMODELLED);
    let Stop::Unmodelled(what) = bench.run(100) else {
        panic!("the run went on");
    };
    assert_eq!(
        what.to_string(),
        "DEVICE + 0x100 is not modelled: the instruction at 0x08000400 reads a word at 0x40000100"
    );
    let mut bench = Bench::new(&[STORE]);
    bench.cpu.set_register(0, 5);
    bench.cpu.set_register(1, 0xE000_ED94);
    let Stop::Unmodelled(what) = bench.run(100) else {
        panic!("the run went on");
    };
    let text = what.to_string();
    assert!(text.starts_with("MPU + 0x4 is not modelled"), "{text}");
    assert!(
        text.ends_with("writes 0x5 as a word at 0xe000ed94"),
        "{text}"
    );
}

#[test]
fn an_unpredictable_instruction_stops_the_run() {
    // LDM R1!, {R1, R2}
    let mut bench = Bench::new(&[0xE8B1, 0x0006]);
    let Stop::Unmodelled(what) = bench.run(100) else {
        panic!("the run went on");
    };
    assert!(what.to_string().contains("0xe8b10006 at 0x08000400"));
}
